// Ball in a countersink: spherical. Leaves all three turns; the seat holds the centre.
//
//    \  ___  /        The ball is the pin, the cone the hole, and the ball touches it between its ends: a ball of
//    radius
//     \(   )/         r touches a cone of half angle h where the cone's radius is r cos h.
#pragma once

#include <cmath>

#include "engine/constraint/recognize/fit.hpp"

namespace verisim {

struct SphereCone {
  using First = Sphere;
  using Second = Cone;
  static constexpr ConstraintKind kKind = ConstraintKind::spherical;

  static bool matches(const Bounded<First>& a, const Bounded<Second>& b, const Tolerances& /*tolerances*/) {
    if (a.role != Role::pin || b.role != Role::hole) return false;
    const double touching = a.shape.radius / std::sqrt(1 + b.tangent * b.tangent);  // r cos h
    return touching > recognizing::radius_low(b) && touching < recognizing::radius_high(b);
  }

  static Constraint make(const Bounded<First>& a, const Bounded<Second>& b) {
    Constraint c = recognizing::between(a, b, kKind, Pairing::point_axis, NormalField::about_point);
    c.pin = Side::a;
    c.normal_source = Side::a;
    return c;
  }
};

}  // namespace verisim
