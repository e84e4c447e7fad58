// Ball in a countersink: spherical. Leaves all three turns; the seat holds the centre.
//
//    \  ___  /        The ball is the pin, the cone the hole, and the ball touches it between its ends: a ball of
//    radius
//     \(   )/         r touches a cone of half angle h where the cone's radius is r cos h.
#pragma once

#include "engine/constraint/recognize/fit.hpp"

namespace verisim {

struct SphereCone {
  using First = Sphere;
  using Second = Cone;
  static constexpr ConstraintKind kKind = ConstraintKind::spherical;

  static bool matches(const Bounded<First>& a, const Bounded<Second>& b, const Tolerances& /*tolerances*/) {
    if (a.role != Role::pin || b.role != Role::hole) return false;
    const double tangent = pinned::tan(b.shape.half_angle);
    const double touching = a.shape.radius * pinned::cos(b.shape.half_angle);
    return touching > b.shape.radius + b.v[0] * tangent && touching < b.shape.radius + b.v[1] * tangent;
  }

  static Constraint make(const Bounded<First>& a, const Bounded<Second>& b) {
    Constraint c = recognizing::between(a, b, kKind, Pairing::point_axis, NormalField::about_point);
    c.pin = Side::a;
    c.guide = Side::a;
    return c;
  }
};

}  // namespace verisim
