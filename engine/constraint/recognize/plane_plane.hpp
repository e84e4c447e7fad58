// Plane on plane: planar. Leaves two slides and the turn about the normal.
//
//      | n_B
//   ===v===      Recognized at any sizes. That the normals are opposed is a matter of the pose: alignment.
//   ---^---
//      | n_A
//
// The larger plane gives the normal: it is the smaller one's border that presses into it, and the place of the contact
// moves with the smaller one. So what lies on a plate does not slide where it tilts in its voxels, and the spring of
// each contact has a potential. (Midway between the two normals it has none: of a tilt theta and a weight W a body on
// a plate felt W theta / 2 sideways, and the two fed each other, e times as far in 1 s: 22 mm in 100 s.)
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
    if (c.a.half_length != c.b.half_length) c.normal_source = c.a.half_length > c.b.half_length ? Side::a : Side::b;
    return c;
  }
};

}  // namespace verisim
