// What curved motion and curved surfaces take from a gap within the step, beyond its linear change, and what they give
// where a place passes by another one. Private to this folder.
#pragma once

#include "engine/exact/candidate.hpp"

namespace verisim::exact {

/// How far from its linear change the gap to a face's surface is at the end of the step [m], if the bodies move as they
/// are taken to (RelativeMotion::during): surfaces and motion are curved, and along the feature the closest place
/// moves. Above 0 only as far as keeps a row from acting whose place passes by without touching. @param face  of the
/// base
/// @param count  of the segments that the row stands for, from c.group on; 0: of its place alone
[[nodiscard]] double curving(const BodyPair& pair, const PlacedFeature& placed, const Candidate& c, std::uint32_t face,
                             std::uint32_t count);

/// Likewise of two edges: of straight ones the distance is that of their lines; else the crossing is looked for again
/// where the step ends, and 0 if it has left the segment.
[[nodiscard]] double curving_of_edges(const BodyPair& pair, const PlacedFeature& placed, const Candidate& c,
                                      const ExactEdge& edge);

/// Only what keeps the row of two edges from acting whose place passes by without touching; else 0.
[[nodiscard]] double passing_of_edges(const BodyPair& pair, const PlacedFeature& placed, const Candidate& c,
                                      const ExactEdge& edge);

}  // namespace verisim::exact
