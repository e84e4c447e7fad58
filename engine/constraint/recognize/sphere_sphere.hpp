// Ball in socket: spherical. Leaves all three turns.
//
//   (  ( . )  )      One hole, one pin; radii as for two cylinders.
#pragma once

#include "engine/constraint/recognize/fit.hpp"

namespace verisim {

struct SphereSphere {
  using First = Sphere;
  using Second = Sphere;
  static constexpr ConstraintKind kKind = ConstraintKind::spherical;

  static bool matches(const Bounded<First>& a, const Bounded<Second>& b, const Tolerances& tolerances) {
    return recognizing::fits(a, b, tolerances);
  }

  static Constraint make(const Bounded<First>& a, const Bounded<Second>& b) {
    return recognizing::pin_in_hole(a, b, kKind, Pairing::point_point, NormalField::about_point);
  }
};

}  // namespace verisim
