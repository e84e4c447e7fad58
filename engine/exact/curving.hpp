// What curved motion and curved surfaces take from a gap within the step, beyond its linear change, and what they give
// where a place passes by another one. Private to this folder.
#pragma once

#include "engine/exact/candidate.hpp"

namespace verisim::exact {

/// A feature at the end of the step, if the bodies move as they are taken to (RelativeMotion::during), and how a face
/// sees it there: found once for the rows of a block. Of one pair of bodies.
class FeatureAfter {
 public:
  void place(const BodyPair& pair, const Feature& feature);
  /// The feature that was placed last.
  [[nodiscard]] const PlacedFeature& placed() const { return placed_; }
  const CurveFromSurface& seen_from(const BodyPair& pair, const AnalyticSurface& surface);

 private:
  PlacedFeature placed_{};
  CurveFromSurface curve_{};
  const AnalyticSurface* surface_ = nullptr;  ///< that sees the curve
};

/// How far from its linear change the gap to a face's surface is at the end of the step [m], if the bodies move so:
/// surfaces and motion are curved, and along the feature the closest place moves. Above 0 only as far as keeps a row
/// from acting whose place passes by without touching.
/// @param after  of the pair's last row; then of this one
/// @param face   of the base
/// @param count  of the segments that the row stands for, from c.group on; 0: of its place alone
[[nodiscard]] double curving(const BodyPair& pair, FeatureAfter& after, const PlacedFeature& placed, const Candidate& c,
                             std::uint32_t face, std::uint32_t count);

/// Likewise of two edges: of straight ones the distance is that of their lines; else the crossing is looked for again
/// where the step ends, and 0 if it has left the segment.
[[nodiscard]] double curving_of_edges(const BodyPair& pair, const PlacedFeature& placed, const Candidate& c,
                                      const ExactEdge& edge);

/// Only what keeps the row of two edges from acting whose place passes by without touching; else 0.
[[nodiscard]] double passing_of_edges(const BodyPair& pair, const PlacedFeature& placed, const Candidate& c,
                                      const ExactEdge& edge);

}  // namespace verisim::exact
