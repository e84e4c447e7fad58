// Virtual coupling: a six-degree-of-freedom spring and damper between a held body and the pose where the handle wants
// it (dissertation section 4.3.1, figure 4.3). It acts at the centre of mass, so that translation and rotation
// decouple.
//
// World coordinates W. The target moves with the handle: X_WT = X_WH X_HB with X_HB as it was when the body was
// grasped.
//   force  = k d + b (v_T - v_C)              d = p_T - p_C                    [m]
//   torque = kappa e + B (omega_T - omega)    e = rotation vector of R_T R^T   [rad]
// Critically damped: b = 2 sqrt(k m); B = 2 sqrt(kappa) I^(1/2), that is 2 sqrt(kappa I_i) about each principal axis.
// Saturation: the sum of spring and damper is cut to force_max, torque_max (as vectors), as a clutch that slips would.
//
// Stability rule (ORACLES section 2: k dt^2/m + 2 b dt/m < 4). With x = dt sqrt(k/m) critical damping makes the left
// side x^2 + 4x, the coupling's share of the budget of 4. It may take at most kCouplingShare = 2, the rest is for
// contact: k <= (sqrt(6) - 2)^2 m/dt^2 = 0.202 m/dt^2, and the same for kappa with the smallest principal inertia.
#pragma once

#include <limits>

#include "engine/base/pose.hpp"
#include "engine/dynamics/body.hpp"

namespace verisim {

inline constexpr double kCouplingShare = 2;

struct CouplingLimits {
  double stiffness_max = 300;                                   ///< N/m (maxStiffness)
  double angular_stiffness_max = 0.1;                           ///< N m/rad (maxAngularStiffness)
  double force_max = std::numeric_limits<double>::infinity();   ///< N (maxCouplingForce)
  double torque_max = std::numeric_limits<double>::infinity();  ///< N m (maxCouplingTorque)
};

/// Constants of one coupling: of a body, a step and limits.
struct Coupling {
  double stiffness = 0;                                         ///< k [N/m]
  double damping = 0;                                           ///< b [N s/m]
  double angular_stiffness = 0;                                 ///< kappa [N m/rad]
  Matrix3d angular_damping_B = Matrix3d::Zero();                ///< B in body axes [N m s/rad]
  double force_max = std::numeric_limits<double>::infinity();   ///< N
  double torque_max = std::numeric_limits<double>::infinity();  ///< N m
  double share = 0;  ///< of the stability budget of 4, at most kCouplingShare when `stabilized`
};

/// `stabilize`: apply the stability rule (explicit forces); a linearly implicit integrator needs none.
/// @pre dt is finite and above 0; the body has mass and inertia; stiffnesses are finite and not negative; the limits of
/// force and torque are above 0
[[nodiscard]] Coupling make_coupling(const RigidBody& body, double dt, const CouplingLimits& limits, bool stabilize);

/// Where the handle wants the body, and how fast that place moves.
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

/// What the damper, and the clutch that slips beyond force_max and torque_max, do together: `damper` as it is unless
/// its sum with the spring exceeds a limit, then what leaves the sum at that limit, in the same direction.
[[nodiscard]] Wrench damper_and_clutch(const Coupling& coupling, const Wrench& spring, const Wrench& damper);

/// Energy stored in the springs [J].
[[nodiscard]] double coupling_energy(const Coupling& coupling, const CouplingForce& force);

}  // namespace verisim
