// A sample slides along its own segment to the place that is nearest to a surface. Private to this folder.
#pragma once

#include <algorithm>
#include <cmath>

#include "engine/exact/exact_body.hpp"

namespace verisim::exact {

/// A feature in the coordinates of the other body.
struct PlacedFeature {
  const Feature* feature;
  Vector3d origin, x, y;
};

/// A place on a feature's curve and what the surface says of it.
struct Slid {
  double t = 0;               ///< from the segment's middle, within +- half_width
  Vector3d p, tangent, bend;  ///< place [m], first and second derivative by t
  SurfaceAt at;
  double slope = 0;  ///< of the distance by t
};

/// The place at t from the sample. Sine and cosine of |t| <= pi/16 by their series: 1e-12 exact.
inline void place(const PlacedFeature& f, const Sample& sample, double t, Slid& slid) {
  slid.t = t;
  if (f.feature->kind == Feature::Kind::arc) {
    const double q = t * t;
    const double cosine = 1 - q * (1.0 / 2 - q * (1.0 / 24 - q * (1.0 / 720 - q * (1.0 / 40320))));
    const double sine = t * (1 - q * (1.0 / 6 - q * (1.0 / 120 - q * (1.0 / 5040))));
    const double c = sample.c * cosine - sample.s * sine;
    const double s = sample.s * cosine + sample.c * sine;
    slid.bend = -c * f.x - s * f.y;
    slid.p = f.origin - slid.bend;
    slid.tangent = c * f.y - s * f.x;
  } else {
    slid.p = f.origin + (sample.c + t) * f.x;
    slid.tangent = f.x;
    slid.bend = Vector3d::Zero();
  }
}

inline void evaluate(const PlacedFeature& f, const Sample& sample, const PreciseSurface& surface, double t,
                     Slid& slid) {
  place(f, sample, t, slid);
  slid.at = surface.at(slid.p);
  slid.slope = slid.at.normal.dot(slid.tangent);
}

/// Newton's method on the distance, kept within the segment. Where the distance has a maximum instead of a minimum the
/// lower end of the segment is taken. Most samples need one step: the distance is nearly a parabola over a segment.
inline void slide(const PlacedFeature& f, const Sample& sample, const PreciseSurface& surface, Slid& slid) {
  constexpr int kStepsMax = 5;
  constexpr double kGain = 1e-10;  // m: what another step would have to win
  const double half = f.feature->half_width;
  if (half == 0) return;
  for (int i = 0; i < kStepsMax; ++i) {
    const double bend = surface.bend(slid.at, slid.tangent) + slid.at.normal.dot(slid.bend);
    const double wanted = bend > 0 ? slid.t - slid.slope / bend : (slid.slope > 0 ? -half : half);
    const double t = std::clamp(wanted, -half, half);
    if (std::abs((t - slid.t) * slid.slope) < kGain) return;
    evaluate(f, sample, surface, t, slid);
  }
}

}  // namespace verisim::exact
