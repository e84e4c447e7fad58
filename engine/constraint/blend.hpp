// Faas's method, the comparator of restoration: solve the recognized constraints for a target pose, pull the body
// towards it with a 6-DoF spring, and blend that wrench with the collision response by alignment.
//
// Source: Faas, as dissertation section 8.3.5 describes it: "a constraint force was computed as the force and torque of
// a 6-DoF spring between a body's current position and the position reported as the solution to the constraint problem.
// The overall response force and torque was the linear combination [...] using the constraint alignment measure". His
// solver was a CAD kernel's, and the rate fell to 100 Hz. This solver is written for the purpose, so that the
// comparison is about the method and not about the library.
//
// The solver. Every engaged constraint (constraint_link.hpp) gives rows: an axis on an axis 2 for direction and 2 for
// position, a plane on a plane 2 and 1, a centre on a centre 3, and so on. Wanted is the pose of B that satisfies them
// and is closest to the present one. Gauss-Newton steps  xi = -(J^T J + lambda 1)^-1 J^T r  start from the present
// pose; rotations count as lengths by the factor `length`. If constraints contradict each other (figures 8.1 and 8.2 of
// the dissertation), the result is their least-squares compromise, each weighted by its alignment. Tapers are solved as
// axes, so that they may leave their seat.
//
// Discontinuity. A constraint is solved for as soon as it engages, however badly it is aligned. With more than one
// constraint the target, and with it the force, may jump when another engages. That is a property of the method.
//
// Body coordinates of A. No allocation. About 1 us for one constraint, 0.2 us for each further one.
#pragma once

#include <span>

#include "engine/constraint/constraint_link.hpp"

namespace verisim {

struct BlendParameters {
  double stiffness = 300;          ///< N/m, the engine's maxStiffness
  double angular_stiffness = 0.1;  ///< N m/rad, maxAngularStiffness
  double length = 0.1;             ///< m: a rotation of 1 rad counts as this displacement
  int steps_max = 4;               ///< Gauss-Newton steps; each about squares the error
};

struct ConstraintForce {
  double alpha = 0;     ///< largest of the constraints'; 0: none engaged, the wrench is zero
  Pose X_AB_target;     ///< the solution of the constraints
  Wrench on_b;          ///< of the spring, about B's `center`
  double residual = 0;  ///< m, 2-norm of the rows at the target: above 0 if constraints contradict each other
  int steps = 0;
};

/// @pre none of `engaged` is null and each alpha is in [0, 1]; the pose is finite and its rotation unit; stiffnesses
/// are finite and not negative, the length is finite and above 0
/// @param center  reference point of B's wrench (its centre of mass), body coordinates of B
[[nodiscard]] ConstraintForce constraint_force(std::span<const Engaged> engaged, const Pose& X_AB,
                                               const Vector3d& center, const BlendParameters& parameters);

/// (1 - alpha) collision + alpha constraint. Both about the same point, in the same coordinates. @pre alpha is in [0,
/// 1]
[[nodiscard]] Wrench blended(const Wrench& collision, const Wrench& constraint, double alpha);

}  // namespace verisim
