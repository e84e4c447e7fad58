// A feature of one body (the mover) as another (the base) sees it, in the base's coordinates, and a place on it that
// may become a row: what the parts of a search share. Private to this folder.
#pragma once

#include <array>
#include <limits>

#include "engine/exact/search.hpp"
#include "engine/exact/slide.hpp"

namespace verisim::exact {

inline constexpr double kNever = std::numeric_limits<double>::infinity();

/// A feature in the coordinates of the base.
struct PlacedFeature {
  const Feature* feature;
  Vector3d origin, x, y;
  [[nodiscard]] bool is_arc() const { return feature->kind == Feature::Kind::arc; }
  [[nodiscard]] Vector3d point(const Place& at) const { return origin + at.c * x + at.s * y; }
  [[nodiscard]] Vector3d tangent(const Place& at) const { return is_arc() ? Vector3d(at.c * y - at.s * x) : x; }
};

/// A row in the making.
struct Candidate {
  std::uint32_t group = 0;  ///< its first sample
  std::uint32_t sample = 0;
  Place place{};
  Vector3d p;  ///< m, the place on the curve
  SurfaceAt at{};
  double gap = 0;
  double gap_ahead = 0;  ///< m, at the end of the step if nothing came between
  Vector3d normal;
  double edge_share = 0;  ///< 0: against a face, up to 1: against the middle of an edge's fold
  double weight = 1;      ///< less where the place is not the mover's boundary
};

/// One number for each sample of a run.
using OfRun = std::array<double, kRun>;

/// Both bodies of a search and how the mover moves.
struct Meeting {
  const ExactBody& mover;
  const ExactBody& base;
  const SearchFrame& frame;

  [[nodiscard]] CurveFromSurface seen_from(const PreciseSurface& surface, const PlacedFeature& placed,
                                           const Twist& twist) const {
    return exact::seen_from(surface, placed.origin, placed.x, placed.y, placed.is_arc(), frame.dt * twist.linear,
                            frame.dt * twist.angular);
  }
  /// How far a place of the mover goes within the step [m].
  [[nodiscard]] Vector3d moved(const Vector3d& p, const Twist& twist) const {
    return frame.dt * (twist.linear + twist.angular.cross(p));
  }
  /// Calls f(i, its measure) for every sample of the run.
  template <typename F>
  void measure_all(const CurveFromSurface& curve, const Run& run, F&& f) const {
    const double* c = &mover.sample_c[run.begin];
    const double* s = &mover.sample_s[run.begin];
    const std::uint32_t count = run.end - run.begin;
    with_measure(curve, [&](auto&& measure_at) {
      for (std::uint32_t i = 0; i < count; ++i) f(i, measure_at(c[i], s[i]));
    });
  }
};

}  // namespace verisim::exact
