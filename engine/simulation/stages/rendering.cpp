#include "engine/simulation/stages/rendering.hpp"

#include <algorithm>
#include <utility>

#include "engine/base/error.hpp"

namespace verisim {
namespace {

Vector3d within(double norm_max, const Vector3d& v) {
  const double norm = v.norm();
  return norm > norm_max ? Vector3d(norm_max / norm * v) : v;
}

/// The reaction to the coupling, about the virtual handle. The damper of a heavy body is more than a hand at the end of
/// a sampled loop can bear: b dt/m_hand, with the arm's part, has to stay below 1 (half of the bound in ORACLES section
/// 2). The lightest hand with its handle is taken as 0.1 kg and 0.001 kg m^2; beyond that the damper, which is there
/// for the body's sake, is rendered weaker. The spring is rendered in full; nothing beyond the coupling's limits.
Wrench felt(const Vector3d& handle, const Coupling& coupling, const CouplingTarget& target, const StepWork& work,
            double dt) {
  constexpr double kMass = 0.1;
  constexpr double kInertia = 0.001;
  const Vector3d arm = target.p_WC - handle;
  const double linear = dt * coupling.damping * (1 / kMass + arm.squaredNorm() / kInertia);
  const double angular = dt * coupling.angular_damping_B.trace() / kInertia;
  const Vector3d force =
      within(coupling.force_max, work.coupling.force - (1 - std::min(1.0, 1 / linear)) * work.coupling_damper.force);
  const Vector3d torque = within(coupling.torque_max,
                                 work.coupling.torque - (1 - std::min(1.0, 1 / angular)) * work.coupling_damper.torque);
  return {-force, -torque - arm.cross(force)};
}

/// Contacts of a body in this frame.
std::uint32_t collisions_of(const World& world, const Contacts& contacts, const ExactResponse& exact,
                            std::size_t body) {
  std::uint32_t count = 0;
  for (const std::size_t l : world.near_links)
    if (world.links[l].first == body || world.links[l].second == body) count += contacts.count(l) + exact.count(l);
  return count;
}

std::string text_of_collision(const World& world, const Note& note) {
  return fmt::format("{} of {} starts to touch, in {} contacts", world.bodies[note.second].name,
                     world.hands[note.first].device->name(), note.a);
}
std::string text_of_turn(const World& world, const Note& note) {
  return fmt::format("{} is turned more than half a turn ahead of '{}': the coupling now pulls it the other way round",
                     world.hands[note.first].device->name(), world.bodies[note.second].name);
}
std::string text_of_report(const World& world, const Note& note) {
  return world.hands[note.first].device->name() + " " + note.detail;
}

void note_collision(const World& world, std::size_t h, Notes& notes) {
  const Hand& hand = world.hands[h];
  if (!hand.collision_starts) return;
  notes.add({.time = world.time(),
             .kind = "collision",
             .text = text_of_collision,
             .first = h,
             .second = hand.body,
             .a = static_cast<double>(hand.collisions)});
}

/// The coupling turns a body the shorter way: at half a turn its torque jumps to the other side.
void note_turn(World& world, std::size_t h, const Vector3d& ahead, Notes& notes) {
  constexpr double kNearHalfATurn = 2.5;  // rad
  Hand& hand = world.hands[h];
  const Vector3d before = std::exchange(hand.ahead, ahead);
  if (before.norm() < kNearHalfATurn || ahead.norm() < kNearHalfATurn || before.dot(ahead) > 0) return;
  notes.add({.time = world.time(), .kind = "coupling", .text = text_of_turn, .first = h, .second = hand.body});
}

}  // namespace

void render(World& world, const Contacts& contacts, const ExactResponse& exact, const Response& response,
            const Motion& motion, Notes& notes) {
  DeviceNotes reports;
  for (std::size_t h = 0; h < world.hands.size(); ++h) {
    Hand& hand = world.hands[h];
    Wrench wrench;
    hand.collisions = 0;
    if (hand.body != kNone) {
      wrench = felt(hand.device->reading().handle.position, world.bodies[hand.body].coupling,
                    response.loads(hand.body).target, motion.work(hand.body), world.dt);
      hand.collisions = collisions_of(world, contacts, exact, hand.body);
      note_turn(world, h, response.loads(hand.body).coupling_at_start.e, notes);
    } else {
      hand.ahead.setZero();
    }
    hand.collision_starts = hand.detector.update(world.time(), hand.collisions);
    note_collision(world, h, notes);
    hand.device->render(wrench, {world.frame, world.time(), world.dt, hand.collisions, hand.collision_starts, {}});
    reports.clear();
    hand.device->report(reports);
    for (const DeviceNotes::Note& report : reports)
      notes.add({.time = world.time(), .kind = report.kind, .text = text_of_report, .first = h, .detail = report.text});
  }
}

}  // namespace verisim
