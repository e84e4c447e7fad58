// Rim on rim: cylindrical, at the moment in which a pin's edge passes a hole's edge.
//
//       ( | | )
//   ___(       )___      Roles and radii as for two cylinders. Two edges that cross press along neither face; of the
//                        directions that the crossing allows, the hole's radius is the one that centres the pin.
#pragma once

#include "engine/constraint/recognize/fit.hpp"

namespace verisim {

struct CircleCircle {
  using First = Circle;
  using Second = Circle;
  static constexpr ConstraintKind kKind = ConstraintKind::cylindrical;

  static bool matches(const Bounded<First>& a, const Bounded<Second>& b, const Tolerances& tolerances) {
    return recognizing::fits(a, b, tolerances);
  }

  static Constraint make(const Bounded<First>& a, const Bounded<Second>& b) {
    return recognizing::pin_in_hole(a, b, kKind, Pairing::axis_axis, NormalField::about_line);
  }
};

}  // namespace verisim
