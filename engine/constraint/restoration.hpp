// Degree-of-freedom restoration: removes from one contact force what opposes a motion that the recognized constraint
// leaves free.
//
// Source: dissertation section 8.4.2, eq. 8.3 to 8.9 for cylinders and planes; the others are derived below from the
// same rule. Pure functions of one contact: no state, no allocation. All vectors in one coordinate system, that of the
// caller (the engine: body coordinates of A).   x: point [m]   f: force [N]   alpha: alignment in [0, 1], 1 = fully
//
// One rule for all. Frictionless surfaces press along their common normal n(x) only. A constraint knows n(x) exactly;
// voxels only approximate it. So the component of f along n is kept and the rest scaled by 1 - alpha:
//       f' = f_par + (1 - alpha) f_perp = (1 - alpha) f + alpha (f.n) n / n^2                                  (8.8)
// Unilateral constraints: the surfaces can push each other apart but not pull (n points from the body that feels f
// towards the other). A force towards the other body is then an artefact as a whole (8.9):
//       f' = (1 - alpha) f                                       if f.n >= 0
// The two agree at f.n = 0, so f' is continuous in f. f' is never longer than f.
//
// n(x) by kind ("unilateral" as above, else both senses are kept):
//   planar       the larger plane's normal, of equal ones A's. Unilateral.                 leaves 2 slides, 1 turn
//   cylindrical  away from the axis: n = r = x - c' (8.3 to 8.5).                        leaves 1 slide, 1 turn
//   conical      the flank is tilted by the half angle h: n = cos h r/|r| - sin h v, v towards the wide end, outward
//                for the inner cone. Unilateral: out of the seat it is free.             leaves 1 turn
//   spherical    away from the centre: n = x - c. Every such force passes the centre and so turns nothing.
//                                                                                       leaves 3 turns
//   annular      ball in tube: the radius about the line through the ball's centre along v. Required is that f leaves
//                the slide along v free (f.v = 0) and passes the ball's centre. Both hold only on the ball's equator,
//                where contacts are. This n keeps the slide, and the spin about v, free to the last bit. The lever
//                arm that remains is the contact's height off the equator: at most sqrt(2 radius depth), and it
//                cancels over a symmetric band (the dissertation: "already handled by the along-axis freedom").
//                                                                                       leaves 1 slide, 3 turns
//   other        ball, roller, edge on a plane: the plane's normal. Unilateral.
//                ring in groove: away from the nearest point of the core circle.
//
// On the axis, at the centre and on the core circle n does not exist. f is then returned unchanged, never NaN.
#pragma once

#include <cmath>

#include "engine/base/pose.hpp"
#include "engine/constraint/constraint.hpp"

namespace verisim {

/// A constraint in one pose: its field of normals in the caller's coordinates, and its alignment.
struct ActiveConstraint {
  ConstraintKind kind = ConstraintKind::none;
  NormalField field = NormalField::constant;
  bool unilateral = false;
  double alpha = 0;
  Vector3d point = Vector3d::Zero();      ///< of the axis; the centre; unused by a constant field
  Vector3d direction = Vector3d::Zero();  ///< unit: of the axis; a constant field's n itself
  double along = 0;   ///< cone: component of n along `direction` (-sin h or +sin h); ring: core radius
  double across = 0;  ///< cone: component of n along the radius (+cos h or -cos h)
};

/// The constraint in the pose X_AB, in coordinates A, as it acts on body B.
/// @pre alpha is in [0, 1]; the pose is finite and its rotation unit; so are the directions of a constraint's sides
[[nodiscard]] ActiveConstraint activate(const Constraint& constraint, const Pose& X_AB, double alpha);

/// n(x), not normalised; zero where it does not exist. About 20 flops; cones and rings need a square root too.
[[nodiscard, gnu::always_inline]] inline Vector3d normal_at(const ActiveConstraint& c, const Vector3d& x) {
  if (c.field == NormalField::constant) return c.direction;
  Vector3d from_point = x - c.point;
  if (c.field == NormalField::about_point) return from_point;
  const double height = c.direction.dot(from_point);
  Vector3d r = from_point - height * c.direction;  // eq. 8.3 and 8.4
  if (c.field == NormalField::about_line) return r;
  const double distance = std::sqrt(r.squaredNorm());
  if (distance == 0) return Vector3d::Zero();
  if (c.field == NormalField::about_cone) return c.across * r + c.along * distance * c.direction;
  return from_point - c.along / distance * r;  // about_ring
}

/// Eq. 8.8, or eq. 8.9 if `unilateral`, with the normal `n` of any length; f as it came if n is zero.
[[nodiscard, gnu::always_inline]] inline Vector3d restore_along(const Vector3d& n, const Vector3d& f, double alpha,
                                                                bool unilateral) {
  const double n_squared = n.squaredNorm();
  if (n_squared == 0) return f;
  const double f_along = f.dot(n);
  if (unilateral && f_along >= 0) return (1 - alpha) * f;
  return (1 - alpha) * f + (alpha * (f_along / n_squared)) * n;
}

/// f' of one contact under one constraint. About 3 ns. What it needs, activate() has asked for.
[[nodiscard]] inline Vector3d restore(const ActiveConstraint& c, const Vector3d& x, const Vector3d& f) {
  return restore_along(normal_at(c, x), f, c.alpha, c.unilateral);
}

}  // namespace verisim
