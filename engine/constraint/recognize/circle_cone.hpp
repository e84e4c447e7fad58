// A rim in or on a cone: conical, in one direction only. A pin's edge in a countersink, a hole's edge on a tapered
// plug, a lead-in chamfer.
//
//    \   ___   /        Not both pins or both holes, and the rim's radius among the cone's radii. The cone gives the
//     \ |   | /         normals: it is the face that the edge touches.
//      \|   |/
#pragma once

#include "engine/constraint/recognize/fit.hpp"

namespace verisim {

struct CircleCone {
  using First = Circle;
  using Second = Cone;
  static constexpr ConstraintKind kKind = ConstraintKind::conical;

  static bool matches(const Bounded<First>& a, const Bounded<Second>& b, const Tolerances& /*tolerances*/) {
    if (a.role == b.role) return false;
    return a.shape.radius > recognizing::radius_low(b) && a.shape.radius < recognizing::radius_high(b);
  }

  static Constraint make(const Bounded<First>& a, const Bounded<Second>& b) {
    Constraint c = recognizing::pin_in_hole(a, b, kKind, Pairing::axis_axis, NormalField::about_cone);
    c.normal_source = Side::b;
    c.clearance = 0;
    c.unilateral = true;
    return c;
  }
};

}  // namespace verisim
