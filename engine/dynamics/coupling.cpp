#include "engine/dynamics/coupling.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim {
namespace {

/// Left side of the stability rule, x = dt sqrt(k / m).
double budget_used_by(double x, double zeta) {
  return x * x + 4 * zeta * x;
}

Vector3d rest_within(double sum_max, const Vector3d& spring, const Vector3d& damper) {
  const Vector3d sum = spring + damper;
  const double norm = sum.norm();
  return norm > sum_max ? Vector3d(sum_max / norm * sum - spring) : damper;
}

}  // namespace

Coupling make_coupling(const RigidBody& body, double dt, const CouplingLimits& limits, bool stabilize) {
  VERISIM_ASSERT(is_positive(dt));
  VERISIM_ASSERT(is_positive(body.mass));
  VERISIM_ASSERT(is_not_negative(limits.stiffness_max));
  VERISIM_ASSERT(is_not_negative(limits.angular_stiffness_max));
  VERISIM_ASSERT(limits.force_max > 0);
  VERISIM_ASSERT(limits.torque_max > 0);
  VERISIM_ASSERT(is_not_negative(limits.damping_ratio));
  const double inertia_min = smallest_eigenvalue(body.inertia_B);
  VERISIM_ASSERT(inertia_min > 0);
  const double zeta = limits.damping_ratio + 0.0;                                // of the two zeros the positive
  const double x_max = std::sqrt(4 * zeta * zeta + kCouplingBudget) - 2 * zeta;  // x^2 + 4 zeta x = kCouplingBudget
  const double bound = x_max * x_max / (dt * dt);
  Coupling c;
  c.stiffness = stabilize ? std::min(limits.stiffness_max, bound * body.mass) : limits.stiffness_max;
  c.angular_stiffness =
      stabilize ? std::min(limits.angular_stiffness_max, bound * inertia_min) : limits.angular_stiffness_max;
  c.force_max = limits.force_max;
  c.torque_max = limits.torque_max;
  c.damping = 2 * zeta * std::sqrt(c.stiffness * body.mass);
  c.angular_damping_B = 2 * zeta * std::sqrt(c.angular_stiffness) * square_root(body.inertia_B);
  if (!stabilize) return c;
  c.budget_used = std::max(budget_used_by(dt * std::sqrt(c.stiffness / body.mass), zeta),
                           budget_used_by(dt * std::sqrt(c.angular_stiffness / inertia_min), zeta));
  return c;
}

CouplingForce coupling_force(const Coupling& coupling, const RigidBody& body, const CouplingTarget& target) {
  VERISIM_ASSERT(is_unit(target.R_WB));
  CouplingForce f;
  const Matrix3d R = body.R_WB.toRotationMatrix();
  f.d = target.p_WC - body.p_WC;
  f.e = vector_from_rotation(target.R_WB * body.R_WB.conjugate());
  f.spring = {coupling.stiffness * f.d, coupling.angular_stiffness * f.e};
  f.damper = {coupling.damping * (target.v_C - body.v_C),
              R * (coupling.angular_damping_B * (R.transpose() * (target.omega - body.omega)))};
  return f;
}

Wrench damper_and_clutch(const Coupling& coupling, const Wrench& spring, const Wrench& damper) {
  return {rest_within(coupling.force_max, spring.force, damper.force),
          rest_within(coupling.torque_max, spring.torque, damper.torque)};
}

double coupling_energy(const Coupling& coupling, const CouplingForce& force) {
  return 0.5 * coupling.stiffness * force.d.squaredNorm() + 0.5 * coupling.angular_stiffness * force.e.squaredNorm();
}

}  // namespace verisim
