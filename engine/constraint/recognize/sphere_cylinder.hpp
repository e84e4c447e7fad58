// Ball in tube: annular (linear annular). Leaves the slide along the tube and all three turns.
//
//   | ( . ) |      The ball is the pin, the cylinder the hole; radii as for two cylinders. The normals point away from
//   |   |   |      the line through the ball's centre along the tube: so the spin about the tube is free to the last
//                  bit, and the slide with it.
#pragma once

#include "engine/constraint/recognize/fit.hpp"

namespace verisim {

struct SphereCylinder {
  using First = Sphere;
  using Second = Cylinder;
  static constexpr ConstraintKind kKind = ConstraintKind::annular;

  static bool matches(const Bounded<First>& a, const Bounded<Second>& b, const Tolerances& tolerances) {
    return a.role == Role::pin && b.role == Role::hole && recognizing::fits(a, b, tolerances);
  }

  static Constraint make(const Bounded<First>& a, const Bounded<Second>& b) {
    Constraint c = recognizing::pin_in_hole(a, b, kKind, Pairing::point_axis, NormalField::about_line);
    c.normal_source = Side::a;
    return c;
  }
};

}  // namespace verisim
