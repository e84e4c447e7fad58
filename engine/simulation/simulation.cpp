// The public face of a Simulation: see step.cpp for what a frame does.
#include "engine/simulation/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/base/error.hpp"
#include "engine/simulation/implementation.hpp"
#include "engine/simulation/world.hpp"

namespace verisim {

Simulation::Simulation(const Scene& scene, const SimulationOptions& options)
    : implementation_(std::make_unique<Implementation>(scene, options)) {}
Simulation::~Simulation() = default;

std::uint64_t Simulation::frame() const {
  return implementation_->world.frame;
}
double Simulation::time() const {
  return implementation_->world.time();
}
double Simulation::dt() const {
  return implementation_->world.dt;
}
std::uint64_t Simulation::frames_planned() const {
  const World& world = implementation_->world;
  double longest = 0;
  for (const Hand& hand : world.hands) longest = std::max(longest, hand.device->duration());
  for (const auto& companion : world.companions) longest = std::max(longest, companion->duration());
  const double duration = world.parameters.duration.value_or(longest > 0 ? longest : 1.0);
  return static_cast<std::uint64_t>(std::llround(duration / world.dt));
}
std::uint64_t Simulation::collision_frames() const {
  return implementation_->recording.totals().collision_frames;
}
const FrameCost& Simulation::cost() const {
  return implementation_->cost;
}
std::uint64_t Simulation::state_hash() const {
  return implementation_->recording.hash();
}
const Totals& Simulation::totals() const {
  return implementation_->recording.totals();
}

std::size_t Simulation::body_count() const {
  return implementation_->world.bodies.size();
}

int Simulation::body_index(const std::string& name) const {
  for (std::size_t i = 0; i < implementation_->world.bodies.size(); ++i)
    if (implementation_->world.bodies[i].name == name) return static_cast<int>(i);
  return -1;
}

Pose Simulation::body_pose(std::size_t body) const {
  return implementation_->world.bodies.at(body).rigid.pose();
}

Twist Simulation::body_twist(std::size_t body) const {
  const RigidBody& rigid = implementation_->world.bodies.at(body).rigid;
  return {rigid.v_C, rigid.omega};
}

Wrench Simulation::body_force(std::size_t body) const {
  return implementation_->stages.reactions.on_body(body);
}
std::uint64_t Simulation::body_contacts(std::size_t body) const {
  return implementation_->stages.contacts.of_body(body) + implementation_->stages.exact.of_body(body);
}
double Simulation::mass(std::size_t body) const {
  return implementation_->world.bodies.at(body).rigid.mass;
}

void Simulation::set_body_pose(std::size_t index, const Pose& X_WB) {
  Body& body = implementation_->world.bodies.at(index);
  if (!X_WB.position.allFinite() || !X_WB.rotation.coeffs().allFinite())
    fail(ErrorKind::input, "'{}': the pose to set is not finite", body.name);
  if (!body.can_move)
    fail(ErrorKind::input, "'{}' is fixed: nothing but a moving body can be put elsewhere", body.name);
  body.rigid.set_pose(X_WB);
  body.rigid.v_C = body.rigid.omega = Vector3d::Zero();
}

void Simulation::set_hybrid_enabled(std::size_t body, bool enabled) {
  implementation_->world.bodies.at(body).hybrid_enabled = enabled;
}
void Simulation::grasp(std::size_t device, std::size_t body) {
  Grasping::take(implementation_->world, device, body, true, implementation_->events);
}
void Simulation::release(std::size_t device) {
  Grasping::let_go(implementation_->world, device, implementation_->events);
}

void Simulation::add_clock(double rate_hz, std::function<void(double)> f) {
  implementation_->world.clocks.add(rate_hz, std::move(f));
}

void Simulation::add_event(const std::string& kind, const std::string& text) {
  implementation_->events.push_back({time(), kind, text});
}

const std::vector<Event>& Simulation::events() const {
  return implementation_->events;
}
void Simulation::clear_events() {
  implementation_->events.clear();
}

const StageTimes& Simulation::stage_ns() const {
  return implementation_->stage_ns;
}

void Simulation::describe(Schema& schema) const {
  for (const Column& column : implementation_->recording.schema().columns()) schema.add(column);
}

void Simulation::write_row(std::byte* row) const {
  const std::vector<std::byte>& from = implementation_->recording.row();
  std::memcpy(row, from.data(), from.size());
}

Simulation::Energy Simulation::energy() const {
  const Ledger& l = implementation_->stages.energy.ledger();
  const EnergyState& e = implementation_->stages.energy.state();
  return {e.kinetic, e.coupling, e.gravity, l.dissipated(), l.contact(), l.input(), l.numerical(), l.residual(e)};
}

}  // namespace verisim
