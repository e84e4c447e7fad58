// The place on a sample's segment at which the ball that the curve carries is closest to a surface. Private to this
// folder.
#pragma once

#include <algorithm>
#include <cmath>

#include "engine/exact/meridian.hpp"

namespace verisim::exact {

/// A place on a feature's curve. For an arc c and s are cosine and sine of its parameter, for a line the parameter and
/// 0.
struct Place {
  double t;  ///< parameter, counted from the segment's middle
  double c, s;
};

/// The place `t` beyond the segment's middle (c, s). Cosine and sine of t by their series, to 1e-12. On an arc |t| is
/// at most pi / 16: asserted of a feature's segments when it is made (feature_maker.cpp), not here, in Newton's steps.
inline Place place_at(bool is_arc, double c, double s, double t) {
  if (!is_arc) return {t, c + t, s};
  const double q = t * t;
  const double cosine = 1 - q * (1.0 / 2 - q * (1.0 / 24 - q * (1.0 / 720 - q * (1.0 / 40320))));
  const double sine = t * (1 - q * (1.0 / 6 - q * (1.0 / 120 - q * (1.0 / 5040))));
  return {t, c * cosine - s * sine, s * cosine + c * sine};
}

/// The place of a straight segment, of middle c, that is closest to a plane: an end, or the middle if no end is closer
/// by `gain`. @param slope  of the gap along the segment
inline Place closest_place_to_plane(double c, double s, double half, double slope, double gain) {
  const double t = slope > 0 ? -half : half;
  return std::abs(t * slope) < gain ? Place{0, c, s} : place_at(false, c, s, t);
}

constexpr double kClosestPlaceGain =
    1e-10;  // m, the accuracy that SearchThresholds count on: what another step would have to win

/// Newton's method on the distance, started at the segment's middle (c, s), within the part of the segment in which the
/// slopes met so far leave the minimum: beside an axis or an apex the distance turns more sharply than a parabola, and
/// Newton's steps alone would jump over the place, or to and fro. Where the distance has a maximum instead of a
/// minimum, the downhill end is taken. Over most segments the distance is nearly a parabola, and one step is enough.
/// @param half          of the segment's width, in t
/// @param radius_slope  derivative by t of the radius of the ball that the curve carries
/// @param at_middle     if it is known
inline Place closest_place(const CurveFromSurface& curve, double c, double s, double half, double radius_slope = 0,
                           const Measure* at_middle = nullptr) {
  constexpr int kStepsMax = 40;  // a bound of the work: two are needed, or as many as halve the segment to nothing
  constexpr int kNewtonMax = 4;  // then halves: Newton's steps are of no use where the distance has a kink
  Place at{0, c, s};
  if (half == 0) return at;
  if (curve.surface.kind == SurfaceKind::plane && !curve.is_arc)
    return closest_place_to_plane(c, s, half, curve.x.z() - radius_slope, kClosestPlaceGain);
  with_measure(curve, [&](auto&& measure_at) {
    double low = -half;
    double high = half;
    for (int i = 0; i < kStepsMax; ++i) {
      const Measure m = i == 0 && at_middle != nullptr ? *at_middle : measure_at(at.c, at.s);
      const double slope = m.slope - radius_slope;
      (slope > 0 ? high : low) = at.t;
      const double wanted = m.bend > 0 ? at.t - slope / m.bend : (slope > 0 ? low : high);
      double t = std::clamp(wanted, low, high);
      const bool is_at_end = t == -half || t == half;
      // The last step wins no distance, but a place: sqrt(kClosestPlaceGain / bend) beside it, on the part that turns,
      // a round body at rest would be pushed beside its axis and spun.
      const bool is_last = std::abs((t - at.t) * slope) < kClosestPlaceGain;
      if (is_last && !(m.bend * half * half > kClosestPlaceGain)) return;
      if (i >= kNewtonMax && !is_at_end && !is_last) t = 0.5 * (low + high);
      at = place_at(curve.is_arc, c, s, t);
      if (is_last) return;
    }
  });
  return at;
}

}  // namespace verisim::exact
