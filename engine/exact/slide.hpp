// A sample slides along its own segment to the place where the ball that it carries is nearest to a surface. Private to
// this folder.
#pragma once

#include <algorithm>
#include <cmath>

#include "engine/exact/meridian.hpp"

namespace verisim::exact {

/// Cosine and sine of a sample's t plus `t`, or of a line the sum itself: what c and s are there. Sine and cosine of
/// |t| <= pi/16 by their series: 1e-12 exact.
struct Place {
  double t;  ///< from the segment's middle
  double c, s;
};

inline Place place_at(bool is_arc, double c, double s, double t) {
  if (!is_arc) return {t, c + t, s};
  const double q = t * t;
  const double cosine = 1 - q * (1.0 / 2 - q * (1.0 / 24 - q * (1.0 / 720 - q * (1.0 / 40320))));
  const double sine = t * (1 - q * (1.0 / 6 - q * (1.0 / 120 - q * (1.0 / 5040))));
  return {t, c * cosine - s * sine, s * cosine + c * sine};
}

/// Newton's method on the distance, from the sample's middle, kept within the segment. Where the distance has a maximum
/// instead of a minimum the lower end of the segment is taken. Most samples need one step: the distance is nearly a
/// parabola over a segment.
/// @param growth  of the radius of the ball that the curve carries
inline Place slide(const CurveFromSurface& curve, double c, double s, double half, double growth = 0) {
  constexpr int kStepsMax = 5;
  constexpr double kGain = 1e-10;  // m: what another step would have to win
  Place at{0, c, s};
  if (half == 0) return at;
  with_measure(curve, [&](auto&& measure_at) {
    for (int i = 0; i < kStepsMax; ++i) {
      const Measure m = measure_at(at.c, at.s);
      const double slope = m.slope - growth;
      const double wanted = m.bend > 0 ? at.t - slope / m.bend : (slope > 0 ? -half : half);
      const double t = std::clamp(wanted, -half, half);
      if (std::abs((t - at.t) * slope) < kGain) return;
      at = place_at(curve.is_arc, c, s, t);
    }
  });
  return at;
}

}  // namespace verisim::exact
