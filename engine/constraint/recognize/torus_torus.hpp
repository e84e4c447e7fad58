// Ring in groove: other. Leaves the turn about the common axis (and, lost among the voxels, the roll of the tube).
//
//   ((o))---|---((o))      One groove, one ring: tubes' radii as for two cylinders, core radii within
//                          core_relative_max. The normals point away from the groove's core circle.
#pragma once

#include <algorithm>
#include <cmath>

#include "engine/constraint/recognize/fit.hpp"

namespace verisim {

struct TorusTorus {
  using First = Torus;
  using Second = Torus;
  static constexpr ConstraintKind kKind = ConstraintKind::other;

  static bool matches(const Bounded<First>& a, const Bounded<Second>& b, const Tolerances& tolerances) {
    const double larger = std::max(a.shape.major_radius, b.shape.major_radius);
    if (std::abs(a.shape.major_radius - b.shape.major_radius) > tolerances.core_relative_max * larger) return false;
    const double tube_a = a.shape.minor_radius;
    const double tube_b = b.shape.minor_radius;
    if (a.role == Role::hole && b.role == Role::pin) return recognizing::is_fit(tube_a, tube_b, tolerances);
    return a.role == Role::pin && b.role == Role::hole && recognizing::is_fit(tube_b, tube_a, tolerances);
  }

  static Constraint make(const Bounded<First>& a, const Bounded<Second>& b) {
    Constraint c = recognizing::pin_in_hole(a, b, kKind, Pairing::axis_axis, NormalField::about_ring);
    c.clearance = std::abs(a.shape.minor_radius - b.shape.minor_radius);
    return c;
  }
};

}  // namespace verisim
