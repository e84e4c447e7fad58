// The comparator: solve the recognized constraints for a target pose, pull towards it with a spring of six degrees of
// freedom, and mix that with the collision's response by alignment.
//
// Source: Faas, as dissertation section 8.3.5 tells it: "a constraint force was computed as the force and torque of a
// 6-DoF spring between a body's current position and the position reported as the solution to the constraint problem.
// The overall response force and torque was the linear combination [...] using the constraint alignment measure". His
// solver was a CAD kernel's and the rate fell to 100 Hz; this one is written for the purpose, so that the comparison
// with restoration is about the idea and not about the library.
//
// The solver. Every engaged constraint (constraint_link.hpp) gives rows: an axis on an axis 2 for direction and 2 for
// place, a plane on a plane 2 and 1, a centre on a centre 3, and so on. Of all poses of B that satisfy them the nearest
// to the present one is wanted: Gauss-Newton steps  xi = -(J^T J + lambda 1)^-1 J^T r  from the present pose, turns
// measured as lengths by `length`. Where constraints contradict each other (figures 8.1 and 8.2 of the dissertation) it
// is their least-squares compromise, each weighted by its alignment. Tapers are solved as axes: they may leave their
// seat. A constraint that engages is solved for at once, however badly it is aligned: with more than one, the target
// and so the force may jump when another engages. That is this method's nature, not an error of this solver.
//
// Body coordinates of A throughout. Nothing allocates. About 1 us for one constraint, 0.2 us more for each further one.
#pragma once

#include <span>

#include "engine/constraint/constraint_link.hpp"

namespace verisim {

struct BlendParameters {
  double stiffness = 300;          ///< N/m, the engine's maxStiffness
  double angular_stiffness = 0.1;  ///< N m/rad, maxAngularStiffness
  double length = 0.1;             ///< m: a turn of one rad counts as so much way
  int steps_max = 4;               ///< Gauss-Newton steps; each about squares the error
};

struct ConstraintForce {
  double alpha = 0;        ///< largest of the constraints'; 0: nothing engaged, the wrench is zero
  Pose X_AB_target;        ///< where the constraints would have B
  Wrench on_b;             ///< the spring's pull, about B's `center`
  double unsatisfied = 0;  ///< m, root of the sum of squares of what the constraints still miss by: contradictions
  int steps = 0;
};

/// @pre none of `engaged` is null and each alpha is in [0, 1]; the pose is finite and its rotation unit; stiffnesses
/// are finite and not negative, the length is finite and above 0
/// @param center where B's wrench is taken about (its centre of mass), body coordinates of B
[[nodiscard]] ConstraintForce constraint_force(std::span<const Engaged> engaged, const Pose& X_AB,
                                               const Vector3d& center, const BlendParameters& parameters);

/// (1 - alpha) collision + alpha constraint. Both about the same point, in the same coordinates. @pre alpha is in [0,
/// 1]
[[nodiscard]] Wrench blended(const Wrench& collision, const Wrench& constraint, double alpha);

}  // namespace verisim
