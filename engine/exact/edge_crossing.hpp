// Edge against edge: the place where a segment of the mover crosses a convex edge of the base. Along the segment the
// solid's distance is the larger of those from the edge's two faces; where one falls and the other rises it has its
// least value at the crossing. Both faces are as far away there, and the contact normal is perpendicular to both edges.
// Base coordinates [m] (see candidate.hpp). Private to this folder.
#pragma once

#include "engine/exact/candidate.hpp"

namespace verisim::exact {

/// The place of a sample's segment that is closest to a surface.
[[nodiscard]] Place closest_place_to(const BodyPair& pair, const AnalyticSurface& surface, const PlacedFeature& placed,
                                     std::uint32_t sample);

/// Likewise to the two faces of an edge, in their order.
[[nodiscard]] std::array<Place, 2> closest_places_to(const BodyPair& pair, const PlacedFeature& placed,
                                                     const ExactEdge& edge, std::uint32_t sample);

/// False if no place of a straight feature crosses an edge of two planes within reach. All along the feature the normal
/// and the gap of such a crossing are the same, so one look at both answers for all segments. True if the feature is
/// curved or one of the faces is round: they have to be looked at one by one. About 50 flops.
[[nodiscard]] bool may_cross_edge(const BodyPair& pair, const PlacedFeature& placed, const ExactEdge& edge);

/// The crossing by position, or else by the rule of one of the two places: a segment may come to the edge within the
/// step, or slide along one of the faces towards it. If there is one, sets place, p, at, normal, gap and edge_fraction
/// of `c` and returns true. @param near  places of the segment c.sample that are closest to the edge's faces
/// @pre the edge is a convex one of the base, and both its faces have surfaces
[[nodiscard]] bool cross_edge(const BodyPair& pair, const PlacedFeature& placed, const ExactEdge& edge,
                              const std::array<Place, 2>& near, Candidate& c);

/// True if a crossing that some motion leads to is held where it is now: its place lies on a third face, that can push
/// it. The motion without contact would lead it through that.
/// @param c  place, p and sample are those of the crossing, as they are now
[[nodiscard]] bool lies_already(const BodyPair& pair, const ExactEdge& edge, const Candidate& c);

}  // namespace verisim::exact
