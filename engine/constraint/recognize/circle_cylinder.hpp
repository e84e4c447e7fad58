// A rim on a cylinder: cylindrical. The edge of a hole runs along a pin, or the edge of a pin along a hole's wall; this
// is what a pin meets first, before any of its wall is inside.
//
//   ___       ___
//      (  | |  )     Roles and radii as for two cylinders; a circle has the role of the round face that it bounds. An
//      edge (  | |  )     presses along the normal of the face that it touches: the cylinder gives the normals.
#pragma once

#include "engine/constraint/recognize/fit.hpp"

namespace verisim {

struct CircleCylinder {
  using First = Circle;
  using Second = Cylinder;
  static constexpr ConstraintKind kKind = ConstraintKind::cylindrical;

  static bool matches(const Bounded<First>& a, const Bounded<Second>& b, const Tolerances& tolerances) {
    return recognizing::fits(a, b, tolerances);
  }

  static Constraint make(const Bounded<First>& a, const Bounded<Second>& b) {
    Constraint c = recognizing::pin_in_hole(a, b, kKind, Pairing::axis_axis, NormalField::about_line);
    c.normal_source = Side::b;
    return c;
  }
};

}  // namespace verisim
