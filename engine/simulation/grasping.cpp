// Who holds what: by the button, or said outright by grasp().
#include <cmath>

#include "engine/simulation/world.hpp"

namespace verisim {
namespace {

/// Distance from a point to a body: to the nearest point of its pointshell (half a voxel accurate), 0 inside.
double distance_to(const Body& body, const Vector3d& p_W) {
  const Vector3d p_B = body.rigid.pose().inverse() * p_W;
  if (!body.voxels) return (p_B - p_B.cwiseMax(body.bounds_B.min).cwiseMin(body.bounds_B.max)).norm();
  if (body.voxels->voxmap.layer_at(p_B) <= 0) return 0;
  const Pointshell& shell = body.voxels->shell;
  const Vector3f p = (p_B - shell.reference).cast<float>();
  float nearest = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < shell.size(); ++i)
    nearest = std::min(nearest, (Vector3f(shell.x[i], shell.y[i], shell.z[i]) - p).squaredNorm());
  return std::sqrt(static_cast<double>(nearest));
}

}  // namespace

std::size_t Simulation::Implementation::nearest_body(const Vector3d& p_W) const {
  std::size_t best = kNone;
  double best_distance = grasp_distance;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Body& body = bodies[i];
    if (!body.can_move || !body.selectable || body.held_by != kNone) continue;
    const Vector3d p_B = body.rigid.pose().inverse() * p_W;
    if ((p_B - p_B.cwiseMax(body.bounds_B.min).cwiseMin(body.bounds_B.max)).norm() > best_distance) continue;
    const double d = distance_to(body, p_W);
    if (d < best_distance || (d == best_distance && best == kNone)) {
      best = i;
      best_distance = d;
    }
  }
  return best;
}

void Simulation::Implementation::update_grasps() {
  for (const Grasp& grasp : first_grasps) take(grasp.device, grasp.body, true);
  first_grasps.clear();
  for (std::size_t d = 0; d < devices.size(); ++d) {
    Held& hand = held[d];
    const DeviceReading& reading = devices[d]->reading();
    if (hand.by_script) continue;
    if (hand.body != kNone && !reading.button) let_go(d);
    if (hand.body == kNone && reading.button && devices[d]->driven()) {
      const std::size_t body = nearest_body(reading.handle.position);
      if (body != kNone) take(d, body, false);
    }
  }
}

void Simulation::Implementation::take(std::size_t d, std::size_t index, bool by_script) {
  if (held[d].body != kNone) let_go(d);
  Body& body = bodies[index];
  if (body.held_by != kNone) let_go(body.held_by);
  held[d].body = index;
  held[d].by_script = by_script;
  held[d].X_HB = devices[d]->reading().handle.inverse() * body.rigid.pose();
  body.held_by = d;
  events.push_back({static_cast<double>(frame) * dt, "grasp", devices[d]->name() + " holds " + body.name});
}

void Simulation::Implementation::let_go(std::size_t d) {
  Held& hand = held[d];
  if (hand.body == kNone) return;
  Body& body = bodies[hand.body];
  body.held_by = kNone;
  hand.body = kNone;
  hand.by_script = false;
  if (!parameters.all_bodies_are_dynamic) body.rigid.v_C = body.rigid.omega = Vector3d::Zero();
  events.push_back({static_cast<double>(frame) * dt, "release", devices[d]->name() + " lets go of " + body.name});
}

CouplingTarget Simulation::Implementation::target_of(std::size_t d) const {
  const Held& hand = held[d];
  const RigidBody& rigid = bodies[hand.body].rigid;
  const Pose now = devices[d]->reading().handle * hand.X_HB;
  const Pose before = hand.handle_before * hand.X_HB;
  CouplingTarget target;
  target.p_WC = now * rigid.p_BC;
  target.R_WB = now.rotation;
  target.v_C = (target.p_WC - before * rigid.p_BC) / dt;
  target.omega = vector_from_rotation(now.rotation * before.rotation.conjugate()) / dt;
  return target;
}

EnergyState Simulation::Implementation::energy_now() const {
  const double shadow_dt = parameters.integrator == Integrator::semi_implicit ? dt : 0;
  EnergyState e;
  for (const Body& body : bodies) {
    if (!body.can_move) continue;
    e.kinetic += body.rigid.kinetic_energy();
    if (parameters.all_bodies_are_dynamic) {
      const Vector3d weight = body.rigid.mass * parameters.gravity;
      e.gravity += shadow_energy({weight, Vector3d::Zero()}, body.rigid, shadow_dt) - weight.dot(body.rigid.p_WC);
    }
    if (body.held_by == kNone) continue;
    const CouplingForce pull = coupling_force(body.coupling, body.rigid, target_of(body.held_by));
    e.coupling += coupling_energy(body.coupling, pull) + shadow_energy(pull.spring, body.rigid, shadow_dt);
  }
  return e;
}

}  // namespace verisim
