// Which places near a face belong to it: trims, and where two faces meet in an edge, which of them decides
// (exact_link.hpp says by what). Private to this folder.
#pragma once

#include "engine/exact/placed.hpp"

namespace verisim::exact {

/// By which motion the one of two faces at a convex edge is told that decides at a place. Free: the one that will be
/// passed last. A place that lies on one of them slides along that one and does not stumble over the other; what it
/// would do without contact says nothing there, but how it moved before does.
enum class Rule : std::uint8_t { as_is, as_free, as_before };
/// @param a, b   distances of the place from the two faces [m]
/// @param flush  m: SearchThresholds::flush
[[nodiscard]] Rule rule_of(double a, double b, double flush);

/// The face beyond an edge of `face`.
[[nodiscard]] std::uint32_t across(const ExactEdge& edge, std::uint32_t face);

/// Where two faces of the base meet in a convex edge: is `mine` the one that decides at this place? `first`: which of
/// them does where they are as far away.
[[nodiscard]] bool decides(const Meeting& meeting, const Vector3d& p, const SurfaceAt& mine, const SurfaceAt& other,
                           bool first);

/// Does the candidate, whose place, gap and normal are those against `face` of the base, stand for a row against it?
/// Where the sample's segment crosses a convex edge of the face, the candidate becomes that of edge against edge.
/// Sets its weight.
[[nodiscard]] bool admit(const Meeting& meeting, const PlacedFeature& placed, std::uint32_t face, Candidate& c);

}  // namespace verisim::exact
