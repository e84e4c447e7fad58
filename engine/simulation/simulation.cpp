// The public face of a Simulation: see step.cpp for what a frame does.
#include "engine/simulation/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/base/error.hpp"
#include "engine/base/text.hpp"
#include "engine/simulation/implementation.hpp"
#include "engine/simulation/known_surface.hpp"
#include "engine/simulation/world.hpp"

namespace verisim {

Simulation::Simulation(Scene scene, const SimulationOptions& options)
    : implementation_(std::make_unique<Implementation>(std::move(scene), options)) {
  prepare();
}
Simulation::~Simulation() = default;

std::size_t Simulation::Implementation::add_link(std::size_t first, std::size_t second) {
  for (const std::size_t body : {first, second}) maker.make(world, body);
  world.links.push_back({first, second});
  stages.add_link(world, world.links.size() - 1);
  recording.make_room(world.links.size());
  notes.make_room(world, world.links.size());
  return world.links.size() - 1;
}

void Simulation::Implementation::meet(std::size_t first, std::size_t second) {
  const std::size_t known = stages.neighbours.link_of(first, second);
  const std::size_t l = known == kNone ? add_link(first, second) : known;
  world.links[l].number = met.size();
  met.push_back({static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(second)});
  events.push_back({world.time(), "near",
                    fmt::format("'{}' and '{}' come near each other for the first time", world.bodies[first].name,
                                world.bodies[second].name)});
  PairMethods::tell(world, l, events);
}

void Simulation::prepare() {
  Implementation& self = *implementation_;
  Neighbours& neighbours = self.stages.neighbours;
  self.tell();
  if (self.poses_set) neighbours.look_anew();
  if (self.poses_set) self.look_around();
  self.poses_set = false;
  self.stages.exact.make_room();
  while (neighbours.missed_some() || !neighbours.strangers().empty()) {
    for (const auto& [first, second] : neighbours.strangers()) self.meet(first, second);
    if (neighbours.missed_some()) neighbours.make_room(self.world);
    self.look_around();
  }
  self.stages.exact.look_inside(self.world, self.stages.methods, self.notes);
}

std::size_t Simulation::prepare_all() {
  Implementation& self = *implementation_;
  for (const auto& [first, second] : self.maker.pairs_that_can_meet(self.world))
    if (self.stages.neighbours.link_of(first, second) == kNone) self.add_link(first, second);
  return self.world.links.size();
}

std::vector<PairAnswers> Simulation::answers() const {
  const Implementation& self = *implementation_;
  std::vector<PairAnswers> answers;
  for (const auto& [first, second] : self.met) {
    const std::size_t l = self.stages.neighbours.link_of(first, second);
    const Hybrid asked = PairMethods::asked_of(self.world, l);
    const PairTotals& total = self.recording.totals_of(l);
    const Body &a = self.world.bodies[first], &b = self.world.bodies[second];
    const std::string off = why_off(self.world, a, b);
    if (total.contacts == 0 || (!asked->needs_entities() && off.empty())) continue;
    PairAnswers of{first, second, a.name, b.name, asked->name(), total.contacts, total.by_voxels, {}};
    if (of.by_voxels > 0) of.why = off.empty() ? why_voxels(a, b, asked) : off;
    if (total.switched_off_frames > 0)
      of.why += fmt::format("{}switched off in {} of {} frames with contact", of.why.empty() ? "" : "; ",
                            total.switched_off_frames, total.frames);
    answers.push_back(std::move(of));
  }
  return answers;
}

std::vector<Event> Simulation::last_events() const {
  std::vector<Event> events;
  for (const PairAnswers& of : answers())
    events.push_back({time(), "voxels",
                      fmt::format("voxels answered {} of {} contacts ({:.3g} %) of '{}' and '{}' under {}{}{}",
                                  of.by_voxels, of.contacts, 100 * of.fraction(), of.first_name, of.second_name,
                                  of.method, of.why.empty() ? "" : ": ", of.why)});
  return events;
}

std::uint64_t Simulation::frame() const {
  return implementation_->world.frame;
}
double Simulation::time() const {
  return implementation_->world.time();
}
double Simulation::dt() const {
  return implementation_->world.dt;
}
bool Simulation::is_implicit() const {
  return implementation_->world.is_implicit();
}
std::uint64_t Simulation::frames_planned() const {
  const World& world = implementation_->world;
  double longest = 0;
  for (const Hand& hand : world.hands) longest = std::max(longest, hand.device->duration());
  for (const auto& companion : world.companions) longest = std::max(longest, companion->duration());
  const double duration = world.parameters.duration.value_or(longest > 0 ? longest : 1.0);
  constexpr double kFramesMax = 1e9;  // what is measured of each frame has to fit into memory
  const double frames = duration / world.dt;
  if (!(frames <= kFramesMax))
    fail(ErrorKind::input, "{} s are {:.3g} frames; {:.0e} at most are simulated: shorten the duration or the trace",
         duration, frames, kFramesMax);
  return static_cast<std::uint64_t>(std::llround(frames));
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
  implementation_->stages.exact.forget(implementation_->world, index);
  implementation_->stages.busy.add(index);
  implementation_->poses_set = true;
}

void Simulation::set_hybrid_enabled(std::size_t body, bool enabled) {
  implementation_->world.bodies.at(body).hybrid_enabled = enabled;
}
void Simulation::grasp(std::size_t device, std::size_t body) {
  Grasping::take(implementation_->world, device, body, true, implementation_->notes);
}
void Simulation::release(std::size_t device) {
  Grasping::let_go(implementation_->world, device, implementation_->notes);
}

void Simulation::add_clock(double rate_hz, std::function<void(double)> f) {
  implementation_->world.clocks.add(rate_hz, std::move(f));
}

void Simulation::add_event(const std::string& kind, const std::string& text) {
  implementation_->tell();
  implementation_->events.push_back({time(), shown(kind), shown(text)});
}

const std::vector<Event>& Simulation::events() const {
  implementation_->tell();
  return implementation_->events;
}
void Simulation::clear_events() {
  implementation_->tell();
  implementation_->events.clear();
}

const StageTimes& Simulation::stage_ns() const {
  return implementation_->stage_ns;
}

void Simulation::describe(Schema& schema) const {
  const Schema& own = implementation_->recording.schema();
  for (const Column& column : own.columns()) schema.add(column);
  for (const Column& column : own.table()) schema.add(column);
  schema.bodies = own.bodies;
  schema.pairs_in_frame = own.pairs_in_frame;
}

void Simulation::write_row(std::byte* row) const {
  VERISIM_ASSERT(row != nullptr);
  const std::vector<std::byte>& from = implementation_->recording.row();
  std::memcpy(row, from.data(), from.size());
}

std::span<const std::size_t> Simulation::awake() const {
  return implementation_->recording.awake();
}

void Simulation::write_awake(std::byte* row) const {
  VERISIM_ASSERT(row != nullptr);
  const std::byte* const from = implementation_->recording.row().data();
  implementation_->recording.each_awake(
      [&](std::size_t offset, std::size_t bytes) { std::memcpy(row + offset, from + offset, bytes); });
}

std::span<const std::byte> Simulation::table_rows() const {
  return implementation_->recording.table_rows();
}

const std::vector<BodyPair>& Simulation::pairs() const {
  return implementation_->met;
}

Simulation::Energy Simulation::energy() const {
  const Ledger& l = implementation_->stages.energy.ledger();
  const EnergyState& e = implementation_->stages.energy.state();
  return {e.kinetic, e.coupling, e.gravity, l.dissipated(), l.contact(), l.input(), l.numerical(), l.residual(e)};
}

}  // namespace verisim
