// Roller on a plane: other. Leaves two slides, the turn about the roller's axis and the one about the normal.
//
//    ( . )
//   -------      The roller is a pin (a hole touches no plane). Its axis along the plane is a matter of the pose.
#pragma once

#include "engine/constraint/recognize/fit.hpp"

namespace verisim {

struct CylinderPlane {
  using First = Cylinder;
  using Second = Plane;
  static constexpr ConstraintKind kKind = ConstraintKind::other;

  static bool matches(const Bounded<First>& a, const Bounded<Second>& /*b*/, const Tolerances& /*tolerances*/) {
    return a.role == Role::pin;
  }

  static Constraint make(const Bounded<First>& a, const Bounded<Second>& b) {
    return recognizing::on_plane(a, b, kKind, Pairing::axis_plane);
  }
};

}  // namespace verisim
