// Cone in cone: conical, in one direction only: pushed in it seats and leaves the turn about the axis; pulled out it is
// free.
//
//   \\  \   /  /     One hole, one pin, half angles within half_angle_difference_max, and a stretch of equal radii on
//    \\  \ /  /      both. The normal leans back from the radius by the half angle, so what pushes out of the seat is
//     \\  V  /       kept and what would hold the cone in it is not.
#pragma once

#include <cmath>

#include "engine/constraint/recognize/fit.hpp"

namespace verisim {

struct ConeCone {
  using First = Cone;
  using Second = Cone;
  static constexpr ConstraintKind kKind = ConstraintKind::conical;

  static bool matches(const Bounded<First>& a, const Bounded<Second>& b, const Tolerances& tolerances) {
    if (a.role == b.role) return false;
    if (std::abs(a.shape.half_angle - b.shape.half_angle) > tolerances.half_angle_difference_max) return false;
    return recognizing::radius_low(a) < recognizing::radius_high(b) &&
           recognizing::radius_low(b) < recognizing::radius_high(a);
  }

  static Constraint make(const Bounded<First>& a, const Bounded<Second>& b) {
    Constraint c = recognizing::pin_in_hole(a, b, kKind, Pairing::axis_axis, NormalField::about_cone);
    c.clearance = 0;  // grows as the cones part: alignment knows
    c.unilateral = true;
    return c;
  }
};

}  // namespace verisim
