// Advances one rigid body by one step, given the loads of that step. Two integrators with one interface. World
// coordinates W, SI units; u = (v, omega) is the velocity of the centre of mass.
//
// semi_implicit. Velocity first, then position with the new velocity (symplectic Euler); all loads are explicit. Stable
// while coupling and contact together use less than 4 of the stability budget (ORACLES section 2); both limit their
// part.
//
// implicit (linearly). Coupling and contact are taken at the end of the step, linearised once:
//   (M + dt D + dt^2 K) u1 = M u0 + dt (f(x0, u0) + D u0)
// with K, D of coupling and contact. Backward Euler: stable for any stiffness that double precision carries (dt^2 K up
// to about 1e13 M), and it damps. One 6 x 6 Cholesky solve, a second one in a step in which a contact separates. The
// coupling's target stays where the handle was sampled. A coupling force or torque that would exceed its limit is
// constant. Contacts are unilateral: the step is taken without the contact if there was none at the start, or if its
// wrench at the end would point against the one at the start.
//
// Contacts between two bodies that both move are explicit in both integrators (contact_mutual): each body is advanced
// alone, and the end of its step is not what the other took it for. Only what both take at the start is equal and
// opposite, so that momentum is kept. Their part of the stability budget is all of it in an implicit step: with A in
// place of M, loads that are taken at the end only add to what is stable.
//
// Energy. A velocity-first step does not conserve a spring's energy U but U + dt/2 f.u, exactly if the spring is linear
// and u along it: f0.(u0 + u1)/2 dt = [U + dt/2 f.u] before - after, where u1 - u0 = dt M^-1 f0. shadow_energy is the
// second term (of the modified, or shadow, Hamiltonian).
//
// Passivity controller, for contacts that must not give more energy than they received. As Hannaford and Ryu,
// "Time-domain passivity control of haptic interfaces" (2002), but it knows the work of a step before the step is done.
// If contact forces are scaled by s, their work is w(s) = s dt f.(u0 + u_free + s du)/2 with u_free the new velocity
// without the contact and du what the whole contact adds (ContactWork). If w(1) exceeds the energy available, the s at
// which w(s) equals it is applied (passive_scale). The controller never pulls and never weakens a force that resists a
// motion. If moving bodies touch each other, the sum of their works counts and one scale applies to all, so that action
// equals reaction and momentum is conserved.
//
// Rotation conserves angular momentum: L1 = L0 + dt torque; the orientation advances as that of a free body with L1
// (free_rotation.hpp: second order, no drift of energy, symmetric bodies exactly); then omega = I1^-1 L1. Spin energy
// stays below |L|^2 / (2 I_min) at any speed: a fast needle cannot blow up.
//
// Every function below that takes a body, its loads and dt requires (each half of a step: for its part):
// @pre dt is finite and above 0; the body has mass, and its state is finite with a unit rotation; the matrices of the
// loads are symmetric, contact_scale is in [0, 1]. Loads need not be finite; then the body becomes infinite, and its
// owner checks that after every step (RigidBody::is_finite).
#pragma once

#include "engine/base/pose.hpp"
#include "engine/dynamics/body.hpp"
#include "engine/dynamics/coupling.hpp"

namespace verisim {

/// The loads on a body during one step; world coordinates, about its centre of mass.
struct Loads {
  Wrench external;                                ///< gravity and the like: constant over the step
  Wrench contact;                                 ///< with what does not move, at the start of the step
  Matrix6d contact_stiffness = Matrix6d::Zero();  ///< K of all contacts (k W); implicit integrator only
  Matrix6d contact_damping = Matrix6d::Zero();    ///< D of all contacts (b W)
  Vector6d contact_drift = Vector6d::Zero();      ///< sum of K times the other body's twist at C
  Wrench contact_mutual;                          ///< with bodies that move: constant over the step
  const Coupling* coupling = nullptr;             ///< null: not held
  CouplingForce coupling_at_start;
  CouplingTarget target;
};

/// How the contact of a step's loads acted. Each part of Loads::contact, with wrench w0 at the start, stiffness K,
/// damping D and drift, acted as scale (w0 + dt (drift - K u1) - D (u1 - u0)); each part of contact_mutual as
/// mutual_scale w0.
struct ContactEnd {
  double scale = 1;  ///< 0: the contact separated
  Vector6d u0 = Vector6d::Zero(), u1 = Vector6d::Zero();
  double mutual_scale = 1;
};
/// @pre dt is finite and above 0; end.scale is in [0, 1]
[[nodiscard]] Wrench wrench_at_end(const Wrench& start, const Matrix6d& K, const Matrix6d& D, const Vector6d& drift,
                                   const ContactEnd& end, double dt);

/// The wrenches applied during a step and their works [J].
struct StepWork {
  Wrench coupling;          ///< on the body
  Wrench coupling_damper;   ///< its part that is not the spring's: damper, and clutch if it slips
  Wrench contact;           ///< on the body
  double contact_work = 0;  ///< work on the body
  double damper = 0;        ///< dissipated in the coupling's damper and clutch, relative to the target's motion
  double input = 0;         ///< by the hand through these two; for the spring see Ledger::add_jump
  double numerical = 0;     ///< lost (or gained, < 0) by the discretization itself: see ledger.hpp
  ContactEnd contact_end;
  /// m, rad: displacement along which the work of a wrench on the body is exactly the kinetic energy it gave.
  Vector6d moved = Vector6d::Zero();
};

/// @param contact_scale  0 to 1, of the passivity controller (passive_scale)
[[nodiscard]] StepWork step_semi_implicit(RigidBody& body, const Loads& loads, double dt, double contact_scale = 1);
[[nodiscard]] StepWork step_implicit(RigidBody& body, const Loads& loads, double dt, double contact_scale = 1);

/// Work [J] of a contact on a body if it is scaled by s: w(s) = quadratic s^2 + linear s. `all` is w(1), rounded as in
/// the step itself.
struct ContactWork {
  double all = 0, quadratic = 0, linear = 0;
  ContactWork& operator+=(const ContactWork& other);
  [[nodiscard]] double at(double scale) const;  ///< @pre scale is in [0, 1]
};
/// The contact work of the step that these loads would make.
[[nodiscard]] ContactWork contact_work_semi_implicit(const RigidBody& body, const Loads& loads, double dt);
[[nodiscard]] ContactWork contact_work_implicit(const RigidBody& body, const Loads& loads, double dt);
/// Largest scale at which the work does not exceed the energy available [J]. Exactly 1 if w(1) does not; 0 if the work
/// is beyond double precision. @pre available >= 0
[[nodiscard]] double passive_scale(double available, const ContactWork& work);

/// [J] of a potential whose force on the body is `force`, while steps of step_semi_implicit advance it (see above).
[[nodiscard]] inline double shadow_energy(const Wrench& force, const RigidBody& body, double dt) {
  return 0.5 * dt * (force.force.dot(body.v_C) + force.torque.dot(body.omega));
}

/// The implicit step in two halves, for contacts that are solved in between (engine/exact). The loads make A u1 = b,
/// and u1 = A^-1 b is the velocity without those contacts.
struct ImplicitStep {
  Matrix6d A = Matrix6d::Zero();  ///< M + dt D + dt^2 K
  Vector6d b = Vector6d::Zero();
  Vector6d free = Vector6d::Zero();                               ///< A^-1 b
  Vector6d spring = Vector6d::Zero(), damper = Vector6d::Zero();  ///< of the coupling, at the start
  Matrix6d K = Matrix6d::Zero(), D = Matrix6d::Zero();            ///< of the coupling
  bool with_contact = false;                                      ///< loads.contact is in A and b
  bool with_mutual = false;                                       ///< loads.contact_mutual is in b
};
[[nodiscard]] ImplicitStep begin_implicit(const RigidBody& body, const Loads& loads, double dt);
/// Moves the body; it ends with velocity u1. @param solved  wrench of the contacts solved in between: dt solved = A u1
/// - b  @param during  velocity with which it moves, if that is another than u1: it was hit within the step
/// @pre `step` comes from begin_implicit
[[nodiscard]] StepWork end_implicit(RigidBody& body, const Loads& loads, const ImplicitStep& step, const Vector6d& u1,
                                    const Wrench& solved, double dt, const Vector6d* during = nullptr);

}  // namespace verisim
