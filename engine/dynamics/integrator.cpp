#include "engine/dynamics/integrator.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/cholesky.hpp"
#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/dynamics/free_rotation.hpp"

namespace verisim {
namespace {

/// What every step asks for: see the header.
void check(const RigidBody& body, const Loads& loads, double dt) {
  VERISIM_ASSERT(is_positive(dt));
  VERISIM_ASSERT(body.mass > 0);
  VERISIM_ASSERT(body.is_finite());
  VERISIM_ASSERT(is_unit(body.R_WB));
  VERISIM_ASSERT(is_symmetric(loads.contact_stiffness));
  VERISIM_ASSERT(is_symmetric(loads.contact_damping));
}

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
  Vector6d during;  ///< along it the body moves: u1, unless it was hit
  double turned;    ///< J, kinetic energy lost because I turns at constant angular momentum
};

/// Moves the body with the velocity `during` for dt and gives it the velocity u1. Angular momentum is conserved while
/// I_W changes.
Motion advance(RigidBody& body, const Vector6d& during, const Vector6d& u1, double dt) {
  const Vector6d before = stacked(body.v_C, body.omega);
  const Vector3d omega_star = u1.tail<3>();
  const Matrix3d inertia = body.inertia_W();
  const Vector3d L1 = inertia * omega_star;
  body.v_C = u1.head<3>();
  body.p_WC += dt * during.head<3>();
  body.R_WB = turned_freely(body, inertia * during.tail<3>(), dt);
  body.omega = body.inertia_inverse_W() * L1;
  return {0.5 * (before + u1), during, 0.5 * omega_star.dot(L1) - 0.5 * body.omega.dot(L1)};
}
Motion advance(RigidBody& body, const Vector6d& u1, double dt) {
  return advance(body, u1, u1, dt);
}

/// The potential energy that the step conserves: the coupling's, with its force `pull`, and the shadow of `external`,
/// whose own potential is linear. @param shadow_dt  dt if the step is velocity-first, else 0
double potential(const RigidBody& body, const Loads& loads, const CouplingForce& pull, double shadow_dt) {
  const double energy = shadow_energy(loads.external, body, shadow_dt);
  if (loads.coupling == nullptr) return energy;
  return energy + coupling_energy(*loads.coupling, pull) + shadow_energy(pull.spring, body, shadow_dt);
}
double potential_at_start(const RigidBody& body, const Loads& loads, double shadow_dt) {
  return potential(body, loads, loads.coupling_at_start, shadow_dt);
}
double potential_at_end(const RigidBody& body, const Loads& loads, double shadow_dt) {
  if (loads.coupling == nullptr) return potential(body, loads, {}, shadow_dt);
  return potential(body, loads, coupling_force(*loads.coupling, body, loads.target), shadow_dt);
}

/// Works of the loads, given the wrenches that were applied. @param energy_before  potential_at_start()
StepWork work_of_step(const RigidBody& body, const Loads& loads, const Motion& motion, const Wrench& spring,
                      const Wrench& damper, const Wrench& contact, double energy_before, double dt, double shadow_dt) {
  StepWork work;
  const Vector6d half_way = dt * motion.middle;
  work.moved = half_way;
  work.contact = contact;
  work.contact_work = stacked(contact).dot(half_way);
  const double stored = potential_at_end(body, loads, shadow_dt) - energy_before;
  work.numerical = motion.turned + stacked(loads.external).dot(dt * motion.during - half_way) - stored;
  if (loads.coupling == nullptr) return work;

  const Vector6d target_moved = dt * stacked(loads.target.v_C, loads.target.omega);
  work.coupling = {spring.force + damper.force, spring.torque + damper.torque};
  work.coupling_damper = damper;
  work.input = stacked(damper).dot(target_moved);
  work.damper = stacked(damper).dot(target_moved - half_way);
  work.numerical -= stacked(spring).dot(half_way);
  return work;
}

}  // namespace

ContactWork& ContactWork::operator+=(const ContactWork& other) {
  all += other.all;
  quadratic += other.quadratic;
  linear += other.linear;
  return *this;
}

double ContactWork::at(double scale) const {
  VERISIM_ASSERT(is_fraction(scale));
  return scale == 1 ? all : (quadratic * scale + linear) * scale;
}

double passive_scale(double available, const ContactWork& work) {
  VERISIM_ASSERT(!(available < 0));  // of a run that diverges it may be no number at all
  if (!(work.all > available)) return 1;
  const double a = work.quadratic;
  const double b = work.linear;
  if (!(a > 0)) return 0;
  const double scale = (std::sqrt(b * b + 4 * a * available) - b) / (2 * a);
  return scale > 0 ? std::min(scale, 1.0) : 0;  // nor may this be: inf - inf
}

namespace {

Wrench scaled(double scale, const Wrench& w) {
  return {scale * w.force, scale * w.torque};
}

/// All contacts at the start of the step.
Wrench contact_at_start(const Loads& loads) {
  Wrench all = loads.contact;
  all += loads.contact_mutual;
  return all;
}

/// Change of velocity by a wrench within the step.
Vector6d velocity_change(const RigidBody& body, const Matrix3d& inertia_inverse, const Wrench& w, double dt) {
  return stacked(dt / body.mass * w.force, dt * (inertia_inverse * w.torque));
}

Wrench damper_of(const Loads& loads) {
  if (loads.coupling == nullptr) return {};
  return damper_and_clutch(*loads.coupling, loads.coupling_at_start.spring, loads.coupling_at_start.damper);
}

}  // namespace

ContactWork contact_work_semi_implicit(const RigidBody& body, const Loads& loads, double dt) {
  check(body, loads, dt);
  Wrench others = loads.external;
  if (loads.coupling != nullptr) others += loads.coupling_at_start.spring;
  others += damper_of(loads);
  const Matrix3d inertia_inverse = body.inertia_inverse_W();
  const Vector6d before_and_free =
      2 * stacked(body.v_C, body.omega) + velocity_change(body, inertia_inverse, others, dt);
  const Wrench contact = contact_at_start(loads);
  const Vector6d f = stacked(contact);
  const double quadratic = 0.5 * dt * f.dot(velocity_change(body, inertia_inverse, contact, dt));
  const double linear = 0.5 * dt * f.dot(before_and_free);
  return {quadratic + linear, quadratic, linear};
}

StepWork step_semi_implicit(RigidBody& body, const Loads& loads, double dt, double contact_scale) {
  check(body, loads, dt);
  VERISIM_ASSERT(is_fraction(contact_scale));
  const double energy_before = potential_at_start(body, loads, dt);
  const Wrench spring = loads.coupling == nullptr ? Wrench{} : loads.coupling_at_start.spring;
  const Wrench damper = damper_of(loads);
  const Wrench contact = scaled(contact_scale, contact_at_start(loads));
  const Vector3d force = loads.external.force + contact.force + spring.force + damper.force;
  const Vector3d torque = loads.external.torque + contact.torque + spring.torque + damper.torque;
  const Vector6d u1 =
      stacked(body.v_C, body.omega) + velocity_change(body, body.inertia_inverse_W(), {force, torque}, dt);
  const Motion motion = advance(body, u1, dt);
  StepWork work = work_of_step(body, loads, motion, spring, damper, contact, energy_before, dt, dt);
  work.contact_end.scale = work.contact_end.mutual_scale = contact_scale;
  return work;
}

namespace {

/// Linearises the coupling. A force or torque that would exceed its limit at the present velocity is constant.
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

/// The contact wrench of the loads at the end of the step.
Vector6d contact_at_end(const RigidBody& body, const Loads& loads, const Vector6d& u1, double dt) {
  const Vector6d u0 = stacked(body.v_C, body.omega);
  return stacked(loads.contact) + dt * (loads.contact_drift - loads.contact_stiffness * u1) -
         loads.contact_damping * (u1 - u0);
}

enum class Contacts { none, mutual, all };

/// A u1 = b of all loads but of those contacts that are left out.
void assemble(const RigidBody& body, const Loads& loads, double dt, Contacts contacts, ImplicitStep& step) {
  const Vector6d u0 = stacked(body.v_C, body.omega);
  Matrix6d M = Matrix6d::Zero();
  M.topLeftCorner<3, 3>().diagonal().setConstant(body.mass);
  M.bottomRightCorner<3, 3>() = body.inertia_W();
  // f1 = f0 - dt K u1 - D (u1 - u0) for each load; collected for u1.
  step.A = M + dt * step.D + dt * dt * step.K;
  step.b = M * u0 + dt * (stacked(loads.external) + step.spring + step.damper + step.D * u0);
  step.with_mutual = contacts != Contacts::none;
  if (step.with_mutual) step.b += dt * stacked(loads.contact_mutual);
  step.with_contact = contacts == Contacts::all;
  if (step.with_contact) {
    step.A += dt * loads.contact_damping + dt * dt * loads.contact_stiffness;
    step.b += dt * (stacked(loads.contact) + dt * loads.contact_drift + loads.contact_damping * u0);
  }
  step.free = Cholesky6(step.A).solve(step.b);
}

}  // namespace

ImplicitStep begin_implicit(const RigidBody& body, const Loads& loads, double dt) {
  check(body, loads, dt);
  ImplicitStep step;
  linearize(body, loads, dt, step);
  const bool touching = !loads.contact_stiffness.isZero(0) || !loads.contact_damping.isZero(0);
  assemble(body, loads, dt, touching ? Contacts::all : Contacts::mutual, step);
  if (!touching) return step;
  // A contact that would pull by the end of the step has separated. M^-1 weighs forces against torques, so the answer
  // does not depend on the unit of length.
  const Vector6d contact1 = contact_at_end(body, loads, step.free, dt);
  if (contact1.dot(body.inverse_mass_matrix() * stacked(loads.contact)) <= 0)
    assemble(body, loads, dt, Contacts::mutual, step);
  return step;
}

StepWork end_implicit(RigidBody& body, const Loads& loads, const ImplicitStep& step, const Vector6d& u1,
                      const Wrench& solved, double dt, const Vector6d* during) {
  VERISIM_ASSERT(is_positive(dt));
  VERISIM_ASSERT(!step.A.isZero(0));
  const double energy_before = potential_at_start(body, loads, 0);
  const Vector6d u0 = stacked(body.v_C, body.omega);
  Wrench contact = solved;
  if (step.with_contact) contact += wrench_of(contact_at_end(body, loads, u1, dt));
  if (step.with_mutual) contact += loads.contact_mutual;
  const ContactEnd end{step.with_contact ? 1.0 : 0.0, u0, u1, step.with_mutual ? 1.0 : 0.0};
  const Wrench spring = wrench_of(step.spring - dt * (step.K * u1));
  const Wrench damper = wrench_of(step.damper + step.D * (u0 - u1));
  const Motion motion = advance(body, during == nullptr ? u1 : *during, u1, dt);
  StepWork work = work_of_step(body, loads, motion, spring, damper, contact, energy_before, dt, 0);
  work.contact_end = end;
  return work;
}

namespace {

/// An implicit step divided into a step without contact (`free`) and the constant wrench `contact`, that of the end of
/// the step. All of the wrench gives the velocity `with_all`, none of it free.free.
struct DividedStep {
  Vector6d with_all, contact;
  ImplicitStep free;
};

bool has_contact(const Loads& loads, const ImplicitStep& step) {
  return step.with_contact || !stacked(loads.contact_mutual).isZero(0);
}

DividedStep divide(const RigidBody& body, const Loads& loads, const ImplicitStep& step, double dt) {
  DividedStep divided{step.free, stacked(loads.contact_mutual), step};
  if (step.with_contact) divided.contact += contact_at_end(body, loads, step.free, dt);
  assemble(body, loads, dt, Contacts::none, divided.free);
  return divided;
}

}  // namespace

ContactWork contact_work_implicit(const RigidBody& body, const Loads& loads, double dt) {
  const ImplicitStep step = begin_implicit(body, loads, dt);
  if (!has_contact(loads, step)) return {};
  const DividedStep divided = divide(body, loads, step, dt);
  const Vector6d u0 = stacked(body.v_C, body.omega);
  const auto work_along = [&](const Vector6d& velocities) { return 0.5 * dt * divided.contact.dot(velocities); };
  return {work_along(u0 + divided.with_all), work_along(divided.with_all - divided.free.free),
          work_along(u0 + divided.free.free)};
}

StepWork step_implicit(RigidBody& body, const Loads& loads, double dt, double contact_scale) {
  VERISIM_ASSERT(is_fraction(contact_scale));
  const ImplicitStep step = begin_implicit(body, loads, dt);
  if (!has_contact(loads, step) || contact_scale == 1) return end_implicit(body, loads, step, step.free, {}, dt);
  const DividedStep divided = divide(body, loads, step, dt);
  const ContactEnd end{step.with_contact ? contact_scale : 0.0, stacked(body.v_C, body.omega), divided.with_all,
                       contact_scale};
  const Vector6d u1 = divided.free.free + contact_scale * (divided.with_all - divided.free.free);
  StepWork work = end_implicit(body, loads, divided.free, u1, wrench_of(contact_scale * divided.contact), dt);
  work.contact_end = end;
  return work;
}

Wrench wrench_at_end(const Wrench& start, const Matrix6d& K, const Matrix6d& D, const Vector6d& drift,
                     const ContactEnd& end, double dt) {
  VERISIM_ASSERT(is_positive(dt));
  VERISIM_ASSERT(is_fraction(end.scale));
  return wrench_of(end.scale * (stacked(start) + dt * (drift - K * end.u1) - D * (end.u1 - end.u0)));
}

}  // namespace verisim
