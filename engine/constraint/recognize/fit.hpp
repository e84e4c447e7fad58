// Common to recognizers: whether a pin fits a hole, and how the sides of a constraint are filled in.
#pragma once

#include "engine/constraint/constraint.hpp"
#include "engine/constraint/entities.hpp"
#include "engine/constraint/tolerances.hpp"

namespace verisim::recognizing {

/// Which of two curved shapes is the hole: the one of that role, else the partner of a pin, else the larger one.
/// `neither` if both are pins or both are holes.
[[nodiscard]] inline Side hole_of(Role a, double radius_a, Role b, double radius_b) {
  if (a == b) {
    if (a != Role::unknown) return Side::neither;
    return radius_a >= radius_b ? Side::a : Side::b;
  }
  return a == Role::hole || b == Role::pin ? Side::a : Side::b;
}

/// A pin of radius `pin` in a hole of radius `hole` [m].
[[nodiscard]] inline bool is_fit(double hole, double pin, const Tolerances& tolerances) {
  const double clearance = hole - pin;
  return clearance >= -tolerances.interference_max && clearance <= tolerances.clearance_relative_max * hole;
}

template <typename A, typename B>
[[nodiscard]] inline bool fits(const Bounded<A>& a, const Bounded<B>& b, const Tolerances& tolerances) {
  const double radius_a = a.shape.radius;
  const double radius_b = b.shape.radius;
  switch (hole_of(a.role, radius_a, b.role, radius_b)) {
    case Side::a:
      return is_fit(radius_a, radius_b, tolerances);
    case Side::b:
      return is_fit(radius_b, radius_a, tolerances);
    case Side::neither:
      break;
  }
  return false;
}

/// The radii between which a cone lies.
[[nodiscard]] inline double radius_low(const Bounded<Cone>& f) {
  return f.shape.radius - f.half_length * f.tangent;
}
[[nodiscard]] inline double radius_high(const Bounded<Cone>& f) {
  return f.shape.radius + f.half_length * f.tangent;
}

[[nodiscard]] inline ConstraintSide side_of(const Bounded<Plane>& f) {
  return {f.shape.point, f.shape.normal, 0, f.half_length, 0};
}
[[nodiscard]] inline ConstraintSide side_of(const Bounded<Cylinder>& f) {
  return {f.shape.point, f.shape.direction, f.shape.radius, f.half_length, 0};
}
[[nodiscard]] inline ConstraintSide side_of(const Bounded<Cone>& f) {
  return {f.shape.point, f.shape.direction, f.shape.radius, f.half_length, f.tangent};
}
[[nodiscard]] inline ConstraintSide side_of(const Bounded<Sphere>& f) {
  return {f.shape.center, f.shape.direction, f.shape.radius, f.half_length, 0};
}
[[nodiscard]] inline ConstraintSide side_of(const Bounded<Torus>& f) {
  return {f.shape.center, f.shape.direction, f.shape.major_radius, f.half_length, f.shape.minor_radius};
}
[[nodiscard]] inline ConstraintSide side_of(const Bounded<Line>& e) {
  return {e.shape.point, e.shape.direction, 0, e.half_length, 0};
}
[[nodiscard]] inline ConstraintSide side_of(const Bounded<Circle>& e) {
  return {e.shape.center, e.shape.normal, e.shape.radius, e.half_length, 0};
}

/// A constraint whose two sides are a and b.
template <typename A, typename B>
[[nodiscard]] inline Constraint between(const A& a, const B& b, ConstraintKind kind, Pairing pairing,
                                        NormalField field) {
  Constraint c;
  c.kind = kind;
  c.pairing = pairing;
  c.field = field;
  c.normal_source = Side::neither;
  c.pin = Side::neither;
  c.unilateral = false;
  c.clearance = 0;
  c.a = side_of(a);
  c.b = side_of(b);
  return c;
}

/// The same with a plane as b: unilateral, with the plane's normal.
template <typename A>
[[nodiscard]] inline Constraint on_plane(const Bounded<A>& a, const Bounded<Plane>& b, ConstraintKind kind,
                                         Pairing pairing) {
  Constraint c = between(a, b, kind, pairing, NormalField::constant);
  c.normal_source = Side::b;
  c.unilateral = true;
  return c;
}

/// Two sides with a pin and a hole: sets which is which, and the clearance.
template <typename A, typename B>
[[nodiscard]] inline Constraint pin_in_hole(const Bounded<A>& a, const Bounded<B>& b, ConstraintKind kind,
                                            Pairing pairing, NormalField field) {
  Constraint c = between(a, b, kind, pairing, field);
  const Side hole = hole_of(a.role, c.a.radius, b.role, c.b.radius);
  c.pin = opposite(hole);
  c.normal_source = hole;
  c.clearance = hole == Side::a ? c.a.radius - c.b.radius : c.b.radius - c.a.radius;
  return c;
}

}  // namespace verisim::recognizing
