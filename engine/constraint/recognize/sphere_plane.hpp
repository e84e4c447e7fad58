// Ball on a plane: other. Leaves two slides and all three turns; only the normal is held, and only one way.
//
//    ( . )
//   -------      The ball is a pin (a hole touches no plane).
#pragma once

#include "engine/constraint/recognize/fit.hpp"

namespace verisim {

struct SpherePlane {
  using First = Sphere;
  using Second = Plane;
  static constexpr ConstraintKind kKind = ConstraintKind::other;

  static bool matches(const Bounded<First>& a, const Bounded<Second>& /*b*/, const Tolerances& /*tolerances*/) {
    return a.role == Role::pin;
  }

  static Constraint make(const Bounded<First>& a, const Bounded<Second>& b) {
    return recognizing::on_plane(a, b, kKind, Pairing::point_plane);
  }
};

}  // namespace verisim
