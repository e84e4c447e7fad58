// Plane on plane: planar. Leaves two slides and the turn about the normal.
//
//      | n_B
//   ===v===      Recognized at any sizes. That the normals are opposed is a matter of the pose: alignment.
//   ---^---
//      | n_A
#pragma once

#include "engine/constraint/recognize/fit.hpp"

namespace verisim {

struct PlanePlane {
  using First = Plane;
  using Second = Plane;
  static constexpr ConstraintKind kKind = ConstraintKind::planar;

  static bool matches(const Bounded<First>& /*a*/, const Bounded<Second>& /*b*/, const Tolerances& /*tolerances*/) {
    return true;
  }

  static Constraint make(const Bounded<First>& a, const Bounded<Second>& b) {
    Constraint c = recognizing::between(a, b, kKind, Pairing::plane_plane, NormalField::constant);
    c.unilateral = true;
    return c;
  }
};

}  // namespace verisim
