#include "engine/dynamics/integrator.hpp"

#include <Eigen/Cholesky>

namespace verisim {
namespace {

/// A twist as one column (v, omega), a wrench as one column (force, torque).
Vector6d stacked(const Vector3d& linear, const Vector3d& angular) {
  Vector6d column;
  column << linear, angular;
  return column;
}
Vector6d stacked(const Wrench& w) {
  return stacked(w.force, w.torque);
}
Wrench wrench_of(const Vector6d& column) {
  return {column.head<3>(), column.tail<3>()};
}

/// The motion of one step: u1 = (v1, omega*), with omega* the angular velocity that I0 and the new angular momentum
/// give.
struct Motion {
  Vector6d middle;  ///< (u0 + u1) / 2: along it, force times displacement is exactly the change of kinetic energy
  Vector6d during;  ///< u1: along it the body moves
  double turned;    ///< kinetic energy lost because I turns while the angular momentum stays
};

/// Moves the body along `during` for dt. Angular momentum is kept while the orientation, and so I_W, changes.
Motion advance(RigidBody& body, const Vector6d& during, double dt) {
  const Vector6d before = stacked(body.v_C, body.omega);
  const Vector3d omega_star = during.tail<3>();
  const Vector3d L1 = body.inertia_W() * omega_star;
  body.v_C = during.head<3>();
  body.p_WC += dt * body.v_C;
  body.R_WB = (rotation_from_vector(dt * omega_star) * body.R_WB).normalized();
  body.omega = body.inertia_inverse_W() * L1;
  return {0.5 * (before + during), during, 0.5 * omega_star.dot(L1) - 0.5 * body.omega.dot(L1)};
}

/// Works of the loads, given the wrenches that were really applied. `external` is constant: its potential is linear.
StepWork account(const RigidBody& body, const Loads& loads, const Motion& motion, const Wrench& spring,
                 const Wrench& damper, const Wrench& contact, double energy_before, double dt) {
  StepWork work;
  const Vector6d half_way = dt * motion.middle;
  work.contact = contact;
  work.contact_work = stacked(contact).dot(half_way);
  work.numerical = motion.turned + stacked(loads.external).dot(dt * motion.during - half_way);
  if (loads.coupling == nullptr) return work;

  const Vector6d target_moved = dt * stacked(loads.target.v_C, loads.target.omega);
  work.coupling = {spring.force + damper.force, spring.torque + damper.torque};
  work.coupling_damper = damper;
  work.input = stacked(damper).dot(target_moved);
  work.damper = stacked(damper).dot(target_moved - half_way);
  const double stored = coupling_energy(*loads.coupling, body, loads.target) - energy_before;
  work.numerical -= stacked(spring).dot(half_way) + stored;
  return work;
}

double stored_before(const RigidBody& body, const Loads& loads) {
  return loads.coupling == nullptr ? 0 : coupling_energy(*loads.coupling, body, loads.target);
}

}  // namespace

StepWork step_semi_implicit(RigidBody& body, const Loads& loads, double dt) {
  const double energy_before = stored_before(body, loads);
  const Wrench spring = loads.coupling == nullptr ? Wrench{} : loads.coupling_at_start.spring;
  const Wrench damper =
      loads.coupling == nullptr ? Wrench{} : damper_and_clutch(*loads.coupling, spring, loads.coupling_at_start.damper);
  const Vector3d force = loads.external.force + loads.contact.force + spring.force + damper.force;
  const Vector3d torque = loads.external.torque + loads.contact.torque + spring.torque + damper.torque;
  const Vector6d during =
      stacked(body.v_C + dt / body.mass * force, body.omega + dt * (body.inertia_inverse_W() * torque));
  const Motion motion = advance(body, during, dt);
  return account(body, loads, motion, spring, damper, loads.contact, energy_before, dt);
}

namespace {

/// The coupling, linear in the step's end. A force or torque that would exceed its limit at the present velocity is a
/// constant instead.
void linearize(const RigidBody& body, const Loads& loads, double dt, ImplicitStep& step) {
  if (loads.coupling == nullptr) return;
  const Coupling& coupling = *loads.coupling;
  const CouplingForce& start = loads.coupling_at_start;
  step.spring = stacked(start.spring);
  step.damper = stacked(start.damper);
  const Wrench ahead{start.spring.force - dt * coupling.stiffness * body.v_C,
                     start.spring.torque - dt * coupling.angular_stiffness * body.omega};
  const Wrench limited = damper_and_clutch(coupling, ahead, start.damper);
  if (limited.force == start.damper.force) {
    step.K.topLeftCorner<3, 3>().diagonal().setConstant(coupling.stiffness);
    step.D.topLeftCorner<3, 3>().diagonal().setConstant(coupling.damping);
  } else {
    step.damper.head<3>() = ahead.force + limited.force - start.spring.force;
  }
  if (limited.torque == start.damper.torque) {
    const Matrix3d R = body.R_WB.toRotationMatrix();
    step.K.bottomRightCorner<3, 3>().diagonal().setConstant(coupling.angular_stiffness);
    step.D.bottomRightCorner<3, 3>() = R * coupling.angular_damping_B * R.transpose();
  } else {
    step.damper.tail<3>() = ahead.torque + limited.torque - start.spring.torque;
  }
}

/// What the contact in the loads has become by the end of the step.
Vector6d contact_at_end(const RigidBody& body, const Loads& loads, const Vector6d& u1, double dt) {
  const Vector6d u0 = stacked(body.v_C, body.omega);
  return stacked(loads.contact) + dt * (loads.contact_drift - loads.contact_stiffness * u1) -
         loads.contact_damping * (u1 - u0);
}

/// A u1 = b of all loads, the contact in them with or without.
void assemble(const RigidBody& body, const Loads& loads, double dt, bool with_contact, ImplicitStep& step) {
  const Vector6d u0 = stacked(body.v_C, body.omega);
  Matrix6d M = Matrix6d::Zero();
  M.topLeftCorner<3, 3>().diagonal().setConstant(body.mass);
  M.bottomRightCorner<3, 3>() = body.inertia_W();
  // f1 = f0 - dt K u1 - D (u1 - u0) for each load; collected for u1.
  step.A = M + dt * step.D + dt * dt * step.K;
  step.b = M * u0 + dt * (stacked(loads.external) + step.spring + step.damper + step.D * u0);
  step.with_contact = with_contact;
  if (with_contact) {
    step.A += dt * loads.contact_damping + dt * dt * loads.contact_stiffness;
    step.b += dt * (stacked(loads.contact) + dt * loads.contact_drift + loads.contact_damping * u0);
  }
  step.free = step.A.llt().solve(step.b);
}

}  // namespace

ImplicitStep begin_implicit(const RigidBody& body, const Loads& loads, double dt) {
  ImplicitStep step;
  linearize(body, loads, dt, step);
  const bool touching = !loads.contact_stiffness.isZero(0) || !loads.contact_damping.isZero(0);
  assemble(body, loads, dt, touching, step);
  if (!touching) return step;
  // A contact pushes; one that would pull by the end of the step has let go. M^-1 weighs forces against torques, so
  // that the answer does not depend on the unit of length.
  const Vector6d contact1 = contact_at_end(body, loads, step.free, dt);
  if (contact1.dot(body.inverse_mass_matrix() * stacked(loads.contact)) <= 0) assemble(body, loads, dt, false, step);
  return step;
}

StepWork end_implicit(RigidBody& body, const Loads& loads, const ImplicitStep& step, const Vector6d& u1,
                      const Wrench& solved, double dt) {
  const double energy_before = stored_before(body, loads);
  const Vector6d u0 = stacked(body.v_C, body.omega);
  Wrench contact = solved;
  if (step.with_contact) contact += wrench_of(contact_at_end(body, loads, u1, dt));
  const Wrench spring = wrench_of(step.spring - dt * (step.K * u1));
  const Wrench damper = wrench_of(step.damper + step.D * (u0 - u1));
  const Motion motion = advance(body, u1, dt);
  return account(body, loads, motion, spring, damper, contact, energy_before, dt);
}

StepWork step_implicit(RigidBody& body, const Loads& loads, double dt) {
  const ImplicitStep step = begin_implicit(body, loads, dt);
  return end_implicit(body, loads, step, step.free, {}, dt);
}

}  // namespace verisim
