// Virtual coupling: a 6-DoF spring and damper between a held body and its target, the pose that follows the handle
// (dissertation section 4.3.1, figure 4.3). It acts at the centre of mass, where translation and rotation decouple.
//
// World coordinates W. The target moves with the handle: X_WT = X_WH X_HB with X_HB as it was at the grasp.
//   force  = k d + b (v_T - v_C)              d = p_T - p_C                    [m]
//   torque = kappa e + B (omega_T - omega)    e = rotation vector of R_T R^T   [rad]
// Critically damped, unless a damping ratio zeta scales both: b = 2 zeta sqrt(k m); B = 2 zeta sqrt(kappa) I^(1/2),
// that is 2 zeta sqrt(kappa I_i) about each principal axis. Saturation: the sum of spring and damper is limited to
// force_max and torque_max (as vectors), like a slipping clutch.
//
// Stability rule (ORACLES section 2: k dt^2/m + 2 b dt/m < 4, the stability budget). With x = dt sqrt(k/m) the left
// side is x^2 + 4 zeta x. The coupling may use at most kCouplingBudget = 2 of it and leaves the rest to contacts:
// critically damped, k <= (sqrt(6) - 2)^2 m/dt^2 = 0.202 m/dt^2, and the same for kappa with the smallest principal
// inertia.
#pragma once

#include <limits>

#include "engine/base/pose.hpp"
#include "engine/dynamics/body.hpp"

namespace verisim {

inline constexpr double kCouplingBudget = 2;  ///< of the stability budget of 4

struct CouplingLimits {
  double stiffness_max = 300;                                   ///< N/m (maxStiffness)
  double angular_stiffness_max = 0.1;                           ///< N m/rad (maxAngularStiffness)
  double force_max = std::numeric_limits<double>::infinity();   ///< N (maxCouplingForce)
  double torque_max = std::numeric_limits<double>::infinity();  ///< N m (maxCouplingTorque)
  double damping_ratio = 1;                                     ///< zeta, of the critical damping
};

/// Constants of one coupling.
struct Coupling {
  double stiffness = 0;                                         ///< k [N/m]
  double damping = 0;                                           ///< b [N s/m]
  double angular_stiffness = 0;                                 ///< kappa [N m/rad]
  Matrix3d angular_damping_B = Matrix3d::Zero();                ///< B in body axes [N m s/rad]
  double force_max = std::numeric_limits<double>::infinity();   ///< N
  double torque_max = std::numeric_limits<double>::infinity();  ///< N m
  /// Of the stability budget of 4, which explicit forces share: at most kCouplingBudget. 0 if not stabilized: in an
  /// implicit step the coupling takes nothing of it.
  double budget_used = 0;
};

/// @param stabilize  apply the stability rule, needed for explicit forces; a linearly implicit integrator needs none
/// @pre dt is finite and above 0; the body has mass and inertia; stiffnesses are finite and not negative; the limits of
/// force and torque are above 0; damping_ratio is finite and not negative
[[nodiscard]] Coupling make_coupling(const RigidBody& body, double dt, const CouplingLimits& limits, bool stabilize);

/// Target pose of the body and its velocity.
struct CouplingTarget {
  Vector3d p_WC;  ///< m, of the centre of mass
  Quaterniond R_WB;
  Vector3d v_C;    ///< m/s
  Vector3d omega;  ///< rad/s
};

/// The coupling's state in one frame.
struct CouplingForce {
  Vector3d d;     ///< m
  Vector3d e;     ///< rad
  Wrench spring;  ///< on the body about its centre of mass
  Wrench damper;
  [[nodiscard]] Wrench total() const { return {spring.force + damper.force, spring.torque + damper.torque}; }
};
/// A body that a step has just made infinite has a force that is not finite either. @pre target.R_WB is unit
[[nodiscard]] CouplingForce coupling_force(const Coupling& coupling, const RigidBody& body,
                                           const CouplingTarget& target);

/// The wrench that damper and clutch add to the spring's. It is `damper`, unless the sum of both exceeds force_max or
/// torque_max; then the sum is reduced to that limit, in the same direction.
[[nodiscard]] Wrench damper_and_clutch(const Coupling& coupling, const Wrench& spring, const Wrench& damper);

/// Energy stored in the springs [J].
[[nodiscard]] double coupling_energy(const Coupling& coupling, const CouplingForce& force);

}  // namespace verisim
