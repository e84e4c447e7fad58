// Pin in hole: cylindrical. Leaves the turn about the axis and the slide along it.
//
//   |  :   :  |      One must be a hole and the other a pin, and the pin not the larger one: hole - pin within
//   |  : | :  |      [-interference_max, clearance_relative_max x hole]. The forces that are right point away from the
//   |  :   :  |      hole's axis: its wall is what pushes.
#pragma once

#include "engine/constraint/recognize/fit.hpp"

namespace verisim {

struct CylinderCylinder {
  using First = Cylinder;
  using Second = Cylinder;
  static constexpr ConstraintKind kKind = ConstraintKind::cylindrical;

  static bool matches(const Bounded<First>& a, const Bounded<Second>& b, const Tolerances& tolerances) {
    return recognizing::fits(a, b, tolerances);
  }

  static Constraint make(const Bounded<First>& a, const Bounded<Second>& b) {
    return recognizing::pin_in_hole(a, b, kKind, Pairing::axis_axis, NormalField::about_line);
  }
};

}  // namespace verisim
