// What curved motion and curved surfaces take from a gap within the step, beyond its linear change. Private to this
// folder.
#pragma once

#include "engine/exact/candidate.hpp"

namespace verisim::exact {

/// How far below its linear change the gap to a face's surface is at the end of the step [m, <= 0], if the mover goes
/// on as it did in the last: surfaces and motion are curved, and along the feature the closest place moves.
[[nodiscard]] double curving(const BodyPair& pair, const PlacedFeature& placed, const Candidate& c,
                             const AnalyticSurface& surface);

/// Likewise of two straight edges, whose distance is that of their lines. Of curved ones nobody knows: 0.
[[nodiscard]] double curving_of_edges(const BodyPair& pair, const PlacedFeature& placed, const Candidate& c,
                                      const ExactEdge& edge);

}  // namespace verisim::exact
