#include "engine/constraint/restoration.hpp"

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim {
namespace {

Vector3d point_in_a(const Constraint& c, Side side, const Pose& X_AB) {
  return side == Side::b ? X_AB * c.b.point : c.a.point;
}
Vector3d direction_in_a(const Constraint& c, Side side, const Pose& X_AB) {
  return side == Side::b ? X_AB.rotation * c.b.direction : c.a.direction;
}

/// From B towards A. Of two planes of one size it is A's normal into A: contacts are B's points, pressed along their
/// way in A's coordinates, so a normal that is constant there gives their springs a potential.
Vector3d constant_normal(const Constraint& c, const Pose& X_AB) {
  if (c.normal_source == Side::b) return X_AB.rotation * c.b.direction;
  return -c.a.direction;
}

}  // namespace

ActiveConstraint activate(const Constraint& c, const Pose& X_AB, double alpha) {
  VERISIM_ASSERT(is_placement(X_AB));
  VERISIM_ASSERT(is_fraction(alpha));
  ActiveConstraint active;
  active.kind = c.kind;
  if (c.kind == ConstraintKind::none) return active;
  active.field = c.field;
  active.unilateral = c.unilateral;
  active.alpha = alpha;
  if (c.field == NormalField::constant) {
    active.direction = constant_normal(c, X_AB);
    return active;
  }
  active.point = point_in_a(c, c.normal_source, X_AB);
  // A ball has no axis: that of the tube around it counts.
  active.direction =
      direction_in_a(c, c.pairing == Pairing::point_axis ? opposite(c.normal_source) : c.normal_source, X_AB);
  VERISIM_ASSERT(is_finite(active.point));
  VERISIM_ASSERT(c.field == NormalField::about_point || is_unit(active.direction));
  if (c.field == NormalField::about_cone) {
    const double tangent = c.side(c.normal_source).detail;
    const double cosine = 1 / std::sqrt(1 + tangent * tangent);
    const double outward = c.pin == Side::b ? 1 : -1;  // out of B's material: away from the axis if B is inside
    active.across = outward * cosine;
    active.along = -outward * cosine * tangent;
  }
  if (c.field == NormalField::about_ring) active.along = c.side(c.normal_source).radius;
  return active;
}

}  // namespace verisim
