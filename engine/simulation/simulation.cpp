// The public face of a Simulation: see step.cpp for what a frame does.
#include "engine/simulation/simulation.hpp"

#include <cstring>

#include "engine/base/error.hpp"
#include "engine/simulation/world.hpp"

namespace verisim {

Simulation::Simulation(Scene scene, const SimulationOptions& options)
    : implementation_(std::make_unique<Implementation>(std::move(scene), options)) {}
Simulation::~Simulation() = default;

std::uint64_t Simulation::frame() const {
  return implementation_->frame;
}
double Simulation::time() const {
  return static_cast<double>(implementation_->frame) * implementation_->dt;
}
double Simulation::dt() const {
  return implementation_->dt;
}
std::uint64_t Simulation::frames_planned() const {
  return implementation_->frames_planned;
}
std::uint64_t Simulation::collision_frames() const {
  return implementation_->collision_frames;
}
const FrameCost& Simulation::cost() const {
  return implementation_->cost;
}
std::uint64_t Simulation::state_hash() const {
  return implementation_->hash;
}
const Simulation::Totals& Simulation::totals() const {
  return implementation_->totals;
}

std::size_t Simulation::body_count() const {
  return implementation_->bodies.size();
}

int Simulation::body_index(const std::string& name) const {
  for (std::size_t i = 0; i < implementation_->bodies.size(); ++i)
    if (implementation_->bodies[i].name == name) return static_cast<int>(i);
  return -1;
}

Pose Simulation::body_pose(std::size_t body) const {
  return implementation_->bodies.at(body).rigid.pose();
}

Twist Simulation::body_twist(std::size_t body) const {
  const RigidBody& rigid = implementation_->bodies.at(body).rigid;
  return {rigid.v_C, rigid.omega};
}

Wrench Simulation::body_force(std::size_t body) const {
  return implementation_->bodies.at(body).contact_wrench;
}
std::uint64_t Simulation::body_contacts(std::size_t body) const {
  return implementation_->bodies.at(body).contacts;
}
double Simulation::mass(std::size_t body) const {
  return implementation_->bodies.at(body).rigid.mass;
}

void Simulation::set_body_pose(std::size_t index, const Pose& X_WB) {
  Body& body = implementation_->bodies.at(index);
  if (!X_WB.position.allFinite() || !X_WB.rotation.coeffs().allFinite())
    fail(ErrorKind::input, "'{}': the pose to set is not finite", body.name);
  if (!body.can_move)
    fail(ErrorKind::input, "'{}' is fixed: nothing but a moving body can be put elsewhere", body.name);
  body.rigid.set_pose(X_WB);
  body.rigid.v_C = body.rigid.omega = Vector3d::Zero();
}

void Simulation::set_hybrid_enabled(std::size_t body, bool enabled) {
  implementation_->bodies.at(body).hybrid_enabled = enabled;
}
void Simulation::grasp(std::size_t device, std::size_t body) {
  implementation_->take(device, body, true);
}
void Simulation::release(std::size_t device) {
  implementation_->let_go(device);
}

void Simulation::add_clock(double rate_hz, std::function<void(double)> f) {
  implementation_->clocks.add(rate_hz, std::move(f));
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

const std::array<std::uint32_t, kStageNames.size()>& Simulation::stage_ns() const {
  return implementation_->stage_ns;
}

void Simulation::describe(Schema& schema) const {
  for (const Column& column : implementation_->schema.columns()) schema.add(column);
}

void Simulation::write_row(std::byte* row) const {
  std::memcpy(row, implementation_->row.data(), implementation_->row.size());
}

Simulation::Energy Simulation::energy() const {
  const Ledger& l = implementation_->ledger;
  const EnergyState& e = implementation_->energy;
  return {e.kinetic, e.coupling, e.gravity, l.dissipated(), l.contact(), l.input(), l.numerical(), l.residual(e)};
}

}  // namespace verisim
