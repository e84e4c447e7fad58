// The types that the parts of a contact search use: the two bodies, a feature in the coordinates of the other body, and
// a candidate for a row. One body is the mover, whose features are tested; the other is the base, against whose faces
// they are tested. All vectors in the base's coordinates [m]. Private to this folder.
#pragma once

#include <array>
#include <limits>

#include "engine/exact/closest_place.hpp"
#include "engine/exact/search.hpp"

namespace verisim::exact {

inline constexpr double kOutOfReach = std::numeric_limits<double>::infinity();

/// A feature of the mover in the coordinates of the base.
struct PlacedFeature {
  const Feature* feature;
  Vector3d origin, x, y;  ///< as in Feature
  [[nodiscard]] bool is_arc() const { return feature->kind == Feature::Kind::arc; }
  [[nodiscard]] Vector3d point(const Place& at) const { return origin + at.c * x + at.s * y; }
  [[nodiscard]] Vector3d tangent(const Place& at) const { return is_arc() ? Vector3d(at.c * y - at.s * x) : x; }
};

/// The feature of a mover that is placed so.
[[nodiscard]] inline PlacedFeature placed_by(const Placement& at, const Feature& feature) {
  return {&feature, at.R * feature.origin + at.p, at.R * feature.x, at.R * feature.y};
}

/// A place on a feature that may become a row.
struct Candidate {
  std::uint32_t group = 0;   ///< first sample of the group
  std::uint32_t sample = 0;  ///< the sample on whose segment the place lies
  Place place{};             ///< parameter on the feature's curve
  Vector3d p;                ///< m, the place on the curve
  SurfaceAt at{};            ///< distance and normal of the face at p; of two crossing edges, of the farther one
  double gap = 0;            ///< m, of the ball's boundary from the face
  double gap_ahead = 0;      ///< m, at the end of the step without contact
  bool comes_down = false;   ///< is the place the closest of its segment then, and not now?
  Vector3d normal;           ///< unit, of the contact; that of the face, or of two crossing edges
  double edge_fraction = 0;  ///< 0: the normal is a face's; 1: it lies midway between the two faces of an edge
  double descent = 0;        ///< of a crossing: how steeply the curve comes down to it along the face it leaves less
  double weight = 1;         ///< in [0, 1], scales the stiffness; below 1 where the place is not the mover's boundary
};

/// One number for each sample of a block.
using PerSample = std::array<double, kBlockSize>;

/// The two bodies of a search and their relative motion.
struct BodyPair {
  const ExactBody& mover;
  const ExactBody& base;
  const RelativeMotion& motion;

  /// The feature's curve in a surface's own axes, with the displacement that `twist` gives it in one step.
  [[nodiscard]] CurveFromSurface seen_from(const AnalyticSurface& surface, const PlacedFeature& placed,
                                           const Twist& twist) const {
    return exact::seen_from(surface, placed.origin, placed.x, placed.y, placed.is_arc(), motion.dt * twist.linear,
                            motion.dt * twist.angular);
  }
  /// Displacement of the mover's material point p within one step of `twist` [m].
  [[nodiscard, gnu::always_inline]] Vector3d moved(const Vector3d& p, const Twist& twist) const {
    return motion.dt * (twist.linear + twist.angular.cross(p));
  }
  /// How far a contact's normal lies in the mover's normal cone at a sample: 1 inside of it, 0 from cone_none on.
  [[nodiscard]] double normal_cone_weight(std::uint32_t sample, const Vector3d& normal) const {
    return normal_cone_weight_in_mover(sample, motion.now.R.transpose() * normal);
  }
  /// Likewise, of a normal of edge against edge.
  [[nodiscard]] double edge_cone_weight(std::uint32_t sample, const Vector3d& normal) const {
    return normal_cone_weight_in_mover(sample, motion.now.R.transpose() * normal, motion.thresholds.cone_of_edges);
  }
  /// Sine of the angle by which a normal lies out of the mover's normal cone at a sample; 0 within.
  /// @param n  the normal in the mover's coordinates, here and below
  [[nodiscard]] double outside_normal_cone(std::uint32_t sample, const Vector3d& n) const {
    double outside = 0;
    for (std::uint32_t i = mover.cone_begin[sample]; i < mover.cone_begin[sample + 1]; ++i)
      outside = std::max(outside, -n.dot(mover.cone_directions[i]));
    return outside;
  }
  /// @param scale  of cone_full and cone_none
  [[nodiscard]] double normal_cone_weight_in_mover(std::uint32_t sample, const Vector3d& n, double scale = 1) const {
    const double outside = outside_normal_cone(sample, n);
    const SearchThresholds& fade = motion.thresholds;
    return std::clamp((fade.cone_none * scale - outside) / (scale * (fade.cone_none - fade.cone_full)), 0.0, 1.0);
  }
  /// Calls f(i, measure of sample i) for every sample of the block.
  template <typename F>
  void measure_all(const CurveFromSurface& curve, const SampleBlock& block, F&& f) const {
    const double* c = &mover.sample_c[block.begin];
    const double* s = &mover.sample_s[block.begin];
    const std::uint32_t count = block.end - block.begin;
    with_measure(curve, [&](auto&& measure_at) {
      for (std::uint32_t i = 0; i < count; ++i) f(i, measure_at(c[i], s[i]));
    });
  }
};

}  // namespace verisim::exact
