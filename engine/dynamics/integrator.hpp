// Advancing one rigid body by one step, from the loads of that step. Two integrators, one interface.
//
// semi_implicit: velocity first, then position with the new velocity (symplectic Euler); all loads explicit. Stable
// while the sum of the shares of coupling and contact stays below 4 (ORACLES section 2); both limit themselves.
//
// implicit (linearly): spring, damper and contact are taken at the end of the step, linearised once:
//   (M + dt D + dt^2 K) u1 = M u0 + dt (f(x0, u0) + D u0),   u = (v, omega)
// with K, D of coupling and contact. Stable for any stiffness (backward Euler) that double precision carries, dt^2 K up
// to about 1e13 M; it damps. One 6 x 6 Cholesky solve, a second one in a step in which contact lets go. The coupling's
// target stands still where the handle was sampled; a force or torque of it that would exceed its limit is constant. A
// contact only pushes: if its wrench at the end of the step would point against the one at the start, or there was none
// at the start, the step is taken without it.
//
// Energy: a velocity-first step keeps a spring's energy not as U but as U + dt/2 f.u, exactly if the spring is linear
// and u along it: f0.(u0 + u1)/2 dt = [U + dt/2 f.u] before - after, where u1 - u0 = dt M^-1 f0. shadow_energy is that
// second term (of the modified, or shadow, Hamiltonian): what it lends at one moment it takes back at the next.
//
// Contacts that must not give more energy than they were given: a passivity controller as Hannaford's and Ryu's, but
// one that knows the step's work before it is done and not a step later. The work of a contact of which the share s
// acts is w(s) = s dt f.(u0 + u_free + s du)/2, u_free the new velocity without it, du what all of it adds
// (ContactWork). Where bodies that move touch each other, the sum over them is what counts, and one share is for all:
// what is taken from one side of a contact is taken from the other, and momentum stays. If w(1) exceeds the budget, the
// s at which w(s) meets it acts. It never pulls, nor weakens what resists a motion.
//
// Every function below that takes a body, its loads and dt asks for this (one half of a step: for its part of it):
// @pre dt is finite and above 0; the body has mass, and its state is finite with a unit rotation; the matrices of the
// loads are symmetric, contact_share is in [0, 1]. Loads need not be finite: the body is not either then, and its owner
// asks it after every step (RigidBody::is_finite).
//
// Rotation keeps angular momentum: L1 = L0 + dt torque; the orientation advances with I0^-1 L1; then omega = I1^-1 L1.
// Spin energy stays below |L|^2 / (2 I_min) whatever the speed: a fast needle cannot blow up.
#pragma once

#include "engine/base/pose.hpp"
#include "engine/dynamics/body.hpp"
#include "engine/dynamics/coupling.hpp"

namespace verisim {

/// What acts on a body during one step; world coordinates, about its centre of mass.
struct Loads {
  Wrench external;                                ///< gravity and the like: constant over the step
  Wrench contact;                                 ///< at the start of the step
  Matrix6d contact_stiffness = Matrix6d::Zero();  ///< K of all contacts (k W); implicit integrator only
  Matrix6d contact_damping = Matrix6d::Zero();    ///< D of all contacts (b W)
  Vector6d contact_drift = Vector6d::Zero();  ///< sum of K times the twist of the other body at C: a wall that moves
  const Coupling* coupling = nullptr;         ///< null: not held
  CouplingForce coupling_at_start;
  CouplingTarget target;
};

/// By which rule the contact of a step's loads became what acted. Every part of that contact, wrench w0 with stiffness
/// K, damping D and drift, became share (w0 + dt (drift - K u1) - D (u1 - u0)).
struct ContactEnd {
  double share = 1;  ///< 0: it let go
  Vector6d u0 = Vector6d::Zero(), u1 = Vector6d::Zero();
};
/// @pre dt is finite and above 0; end.share is in [0, 1]
[[nodiscard]] Wrench acted(const Wrench& start, const Matrix6d& K, const Matrix6d& D, const Vector6d& drift,
                           const ContactEnd& end, double dt);

/// What the loads did during the step [J, and the wrenches that were really applied].
struct StepWork {
  Wrench coupling;          ///< on the body
  Wrench coupling_damper;   ///< the part of it that is not the spring's: damper, and clutch if it slips
  Wrench contact;           ///< on the body
  double contact_work = 0;  ///< work on the body
  double damper = 0;        ///< dissipated in the coupling's damper and clutch, relative to the target's motion
  double input = 0;         ///< put in by the hand through these two; through the spring: see Ledger::add_jump
  double numerical = 0;     ///< lost (or gained, < 0) by the discretization itself: see ledger.hpp
  ContactEnd contact_end;
};

/// `contact_share`: 0 to 1, so much of the contact acts (share_within).
[[nodiscard]] StepWork step_semi_implicit(RigidBody& body, const Loads& loads, double dt, double contact_share = 1);
[[nodiscard]] StepWork step_implicit(RigidBody& body, const Loads& loads, double dt, double contact_share = 1);

/// Work [J] on a body of a contact of which the share s acts: w(s) = quadratic s^2 + linear s, and w(1), whose rounding
/// is that of the step itself.
struct ContactWork {
  double all = 0, quadratic = 0, linear = 0;
  ContactWork& operator+=(const ContactWork& other);
  [[nodiscard]] double of(double share) const;  ///< @pre share is in [0, 1]
};
/// Of the step that these loads would make.
[[nodiscard]] ContactWork contact_work_semi_implicit(const RigidBody& body, const Loads& loads, double dt);
[[nodiscard]] ContactWork contact_work_implicit(const RigidBody& body, const Loads& loads, double dt);
/// The share that may act: 1, without a rounding, or that at which the work meets the budget [J]; 0 if the work is
/// beyond double precision. @pre budget >= 0
[[nodiscard]] double share_within(double budget, const ContactWork& work);

/// [J] of a potential whose force on the body is `force`, while steps of step_semi_implicit advance it (see above).
[[nodiscard]] inline double shadow_energy(const Wrench& force, const RigidBody& body, double dt) {
  return 0.5 * dt * (force.force.dot(body.v_C) + force.torque.dot(body.omega));
}

/// The implicit step in two halves, for contacts that are solved between them (engine/exact): all of the loads are in
/// A u1 = b, so that u1 = A^-1 b is the velocity without those contacts.
struct ImplicitStep {
  Matrix6d A = Matrix6d::Zero();  ///< M + dt D + dt^2 K
  Vector6d b = Vector6d::Zero();
  Vector6d free = Vector6d::Zero();                               ///< A^-1 b
  Vector6d spring = Vector6d::Zero(), damper = Vector6d::Zero();  ///< of the coupling, at the start
  Matrix6d K = Matrix6d::Zero(), D = Matrix6d::Zero();            ///< of the coupling
  bool with_contact = false;                                      ///< loads.contact is in A and b
};
[[nodiscard]] ImplicitStep begin_implicit(const RigidBody& body, const Loads& loads, double dt);
/// Moves the body with u1. `solved` is what the contacts solved in between did to it: dt solved = A u1 - b.
/// @pre `step` comes from begin_implicit
[[nodiscard]] StepWork end_implicit(RigidBody& body, const Loads& loads, const ImplicitStep& step, const Vector6d& u1,
                                    const Wrench& solved, double dt);

}  // namespace verisim
