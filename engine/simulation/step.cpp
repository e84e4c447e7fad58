// The order of one frame. To change it is to change every golden hash.
#include <algorithm>
#include <chrono>
#include <cmath>

#include "engine/base/error.hpp"
#include "engine/simulation/world.hpp"
#include "engine/wii/head.hpp"

namespace verisim {

namespace {

/// Times the stages of a frame. The one place where the loop reads a clock; nothing reads what it wrote.
class StageTimer {
 public:
  explicit StageTimer(std::array<std::uint32_t, kStageNames.size()>& stage_ns) : out_(stage_ns), last_(now()) {}
  void done(std::size_t stage) {
    const auto t = now();
    out_[stage] = static_cast<std::uint32_t>(t - last_);
    last_ = t;
  }

 private:
  static std::int64_t now() {
    return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
  }
  std::array<std::uint32_t, kStageNames.size()>& out_;
  std::int64_t last_;
};

Vector3d within(double norm_max, const Vector3d& v) {
  const double norm = v.norm();
  return norm > norm_max ? Vector3d(norm_max / norm * v) : v;
}

}  // namespace

void Simulation::step() {
  Implementation& w = *implementation_;
  StageTimer timer(w.stage_ns);
  const double t = static_cast<double>(w.frame) * w.dt;  // never t += dt: its roundings pile up
  w.sample_devices(t);                                   // raw pose -> virtual handle
  w.update_grasps();
  timer.done(0);
  w.pull();  // virtual coupling
  timer.done(1);
  w.query_contacts();  // broad phase, then pointshell against voxmap
  timer.done(2);
  w.respond();  // penalty force of every contact, summed in pair order
  timer.done(3);
  w.integrate();
  timer.done(4);
  w.render();  // coupling wrench -> what the hardware is told to render
  timer.done(5);
  ++w.frame;
  w.follow_heads();  // Wii remotes, at the times of their reports
  w.clocks.run_due(w.frame,
                   static_cast<double>(w.frame) * w.dt);  // script, trackers, firmware: same thread, fixed order
  timer.done(6);
  w.take_stock();  // energies, totals, the row and its hash
  timer.done(7);
}

void Simulation::Implementation::sample_devices(double t) {
  for (std::size_t d = 0; d < devices.size(); ++d) {
    devices[d]->sample(frame, t, dt);
    const Pose& handle = devices[d]->reading().handle;
    if (!handle.position.allFinite() || !handle.rotation.coeffs().allFinite())
      fail(ErrorKind::diverged, "frame {}: the handle of device '{}' is not finite", frame, devices[d]->name());
    if (!held[d].sampled) held[d].handle_before = handle;
    held[d].sampled = true;
  }
}

/// Gathers what acts on each body besides contact. Whatever changed the energy since the last frame's end was the hand
/// (it moved the handle), a grasp or a script.
void Simulation::Implementation::pull() {
  ledger.add_jump(energy_now().sum() - energy.sum());
  for (Body& body : bodies) {
    body.loads.external = {};
    body.loads.coupling = nullptr;
    body.contacts = 0;
    if (!body.can_move) continue;
    if (parameters.all_bodies_are_dynamic) body.loads.external.force = body.rigid.mass * parameters.gravity;
    if (body.held_by == kNone) continue;
    body.loads.coupling = &body.coupling;
    body.loads.target = target_of(body.held_by);
    body.loads.coupling_at_start = coupling_force(body.coupling, body.rigid, body.loads.target);
  }
}

void Simulation::Implementation::query_contacts() {
  cost = FrameCost();
  for (Link& link : links) {
    link.near = false;
    link.method = method_of(link);
    link.contacts = link.cache_hits = link.cache_misses = 0;
    link.constraint = ConstraintKind::none;
    link.alpha = link.depth_max = 0;
    link.on_second = {};
  }
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (bodies[i].can_move) broad_phase->set_pose(i, bodies[i].rigid.pose());
  for (const auto& [i, j] : broad_phase->find()) {
    Link& link = links[link_of_pair[i * bodies.size() + j]];
    if (!link.contact) continue;
    link.near = true;
    ++cost.pairs_tested;
    if (link.method == Hybrid::exact && !link.voxels_answer) continue;
    QueryCost work;
    link.contact->query(bodies[i].rigid.pose(), bodies[j].rigid.pose(), work);
    cost.clusters += work.clusters;
    cost.points_tested += work.points;
    cost.voxels_read += work.points;
    cost.bytes_touched += bytes_touched(work);
    if (link.method == Hybrid::exact) link.hybrid->drop_known(link.contact->contacts());
    count_contacts(link, link.contact->contacts().size);
  }
  for (Link& link : links)
    if (link.contact && (!link.near || (link.method == Hybrid::exact && !link.voxels_answer))) link.contact->clear();
}

void Simulation::Implementation::count_contacts(Link& link, std::uint32_t contacts) {
  link.contacts += contacts;
  cost.contacts += contacts;
  bodies[link.first].contacts += contacts;
  bodies[link.second].contacts += contacts;
}

void Simulation::Implementation::respond() {
  for (Body& body : bodies) {
    body.links_touching = 0;
    body.reshaped = false;
    body.p_WC_found = body.rigid.p_WC;
    body.loads.contact = {};
    body.loads.contact_stiffness.setZero();
    body.loads.contact_damping.setZero();
    body.loads.contact_drift.setZero();
    if (body.contacts == 0) continue;
    body.link_body = {body.rigid.pose(), body.rigid.p_WC, {body.rigid.v_C, body.rigid.omega}, Matrix6d::Zero(), 0};
    if (moves(body)) body.link_body.inverse_mass = body.rigid.inverse_mass_matrix();
  }
  for (Link& link : links) {
    link.reshaped = link.method != Hybrid::off || (link.reshaped && link.touches());
    if (!link.touches()) continue;
    ++bodies[link.first].links_touching;
    ++bodies[link.second].links_touching;
  }
  for (Body& body : bodies) {
    const double left = 4 - (body.loads.coupling != nullptr ? body.coupling.budget_used : 0);
    if (body.links_touching > 0) body.link_body.budget = left / body.links_touching;
  }
  const bool implicit = parameters.integrator == Integrator::implicit;
  PenaltyParameters penalty{parameters.contact_stiffness, parameters.contact_damping_ratio, true};
  for (Link& link : links) {
    if (!link.touches()) continue;
    const LinkBody& first = bodies[link.first].link_body;
    const LinkBody& second = bodies[link.second].link_body;
    // An implicit step takes the other body as going on as it did: of two that move, each would answer with another
    // force. Only against what does not move may the stiffness go beyond the explicit bound.
    penalty.stabilize = !implicit || (!first.inverse_mass.isZero(0) && !second.inverse_mass.isZero(0));
    const bool restored = link.method == Hybrid::restore;
    if (restored && implicit && restore_normals(link)) {
      link.contact->respond_at_once(first, second, penalty, dt);
    } else {
      link.contact->respond(first, second, penalty, dt);
      if (restored && !implicit) restore_forces(link);
      link.contact->sum_up(first, second, implicit);
    }
    if (link.reshaped) bodies[link.first].reshaped = bodies[link.second].reshaped = true;
    link.depth_max = link.contact->depth_max();
    link.first_side = link.contact->on_first();
    link.second_side = link.contact->on_second();
    if (link.method == Hybrid::blend) blend(link, link.first_side, link.second_side);
    const auto add = [](Loads& loads, const LinkSide& side) {
      loads.contact += side.wrench;
      loads.contact_stiffness += side.stiffness;
      loads.contact_damping += side.damping;
      loads.contact_drift += side.drift;
    };
    add(bodies[link.first].loads, link.first_side);
    add(bodies[link.second].loads, link.second_side);
  }
}

/// What the hand feels: the reaction to the coupling, about the virtual handle. The damper of a heavy body is more than
/// a hand at the end of a sampled loop can bear: b dt/m_hand, with the arm's part, has to stay below 1 (half of the
/// bound in ORACLES section 2). The lightest hand with its handle is taken as 0.1 kg and 0.001 kg m^2; beyond that the
/// damper, which is there for the body's sake, is rendered weaker. The spring is rendered in full; nothing beyond the
/// coupling's limits.
Wrench Simulation::Implementation::felt(const Body& body, const StepWork& work) const {
  constexpr double kMass = 0.1;
  constexpr double kInertia = 0.001;
  const Vector3d arm = body.loads.target.p_WC - devices[body.held_by]->reading().handle.position;
  const double linear = dt * body.coupling.damping * (1 / kMass + arm.squaredNorm() / kInertia);
  const double angular = dt * body.coupling.angular_damping_B.trace() / kInertia;
  const Vector3d force = within(body.coupling.force_max,
                                work.coupling.force - (1 - std::min(1.0, 1 / linear)) * work.coupling_damper.force);
  const Vector3d torque = within(body.coupling.torque_max,
                                 work.coupling.torque - (1 - std::min(1.0, 1 / angular)) * work.coupling_damper.torque);
  return {-force, -torque - arm.cross(force)};
}

void Simulation::Implementation::integrate() {
  if (solver) solve_exactly();
  share_contacts();
  for (Body& body : bodies) {
    if (!moves(body)) continue;  // what nobody holds does not move
    const StepWork work =
        body.solved ? end_implicit(body.rigid, body.loads, body.implicit, body.velocity, body.exact_wrench, dt)
        : parameters.integrator == Integrator::implicit ? step_implicit(body.rigid, body.loads, dt)
                                                        : step_semi_implicit(body.rigid, body.loads, dt);
    if (!body.rigid.is_finite())
      fail(ErrorKind::diverged,
           "frame {}: the state of '{}' is not finite any more; lower the stiffness or the time step", frame,
           body.name);
    body.contact_wrench = work.contact;
    body.contact_end = work.contact_end;
    if (body.held_by != kNone) held[body.held_by].on_hand = felt(body, work);
    ledger.add(work);
  }
  tell_contacts();
}

void Simulation::Implementation::render() {
  for (std::size_t d = 0; d < devices.size(); ++d) {
    if (held[d].body == kNone) held[d].on_hand = {};
    devices[d]->render(held[d].on_hand, dt);
    held[d].handle_before = devices[d]->reading().handle;
  }
}

void Simulation::Implementation::follow_heads() {
  for (const auto& head : heads) head->follow(static_cast<double>(frame) * dt);
}

void Simulation::Implementation::take_stock() {
  if (cost.contacts > 0) ++collision_frames;
  totals.contacts += cost.contacts;
  decltype(totals.constraint_frames) active{};  // 0 or 1 per kind
  for (const Link& link : links) {
    totals.penetration_max = std::max(totals.penetration_max, link.depth_max);
    totals.cache_hits += link.cache_hits;
    totals.cache_misses += link.cache_misses;
    if (link.constraint != ConstraintKind::none) active[static_cast<std::size_t>(link.constraint)] = 1;
  }
  for (std::size_t kind = 0; kind < active.size(); ++kind) totals.constraint_frames[kind] += active[kind];
  for (const Body& body : bodies)
    if (moves(body)) totals.force_max = std::max(totals.force_max, body.contact_wrench.force.norm());
  energy = energy_now();
  fill_row();
}

}  // namespace verisim
