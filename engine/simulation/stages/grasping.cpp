#include "engine/simulation/stages/grasping.hpp"

#include <cmath>

#include "engine/base/error.hpp"

namespace verisim {
namespace {

std::string text_of_grasp(const World& world, const Note& note) {
  return world.hands[note.first].device->name() + " holds " + world.bodies[note.second].name;
}
std::string text_of_release(const World& world, const Note& note) {
  return world.hands[note.first].device->name() + " lets go of " + world.bodies[note.second].name;
}

Vector3d nearest_in_box(const Bounds& box, const Vector3d& p) {
  return p.cwiseMax(box.min).cwiseMin(box.max);
}

/// Distance from a point to a body: to the nearest point of its pointshell (half a voxel accurate), 0 inside.
double distance_to(const Body& body, const Vector3d& p_W) {
  const Vector3d p_B = body.rigid.pose().inverse() * p_W;
  if (!body.voxels) return (p_B - nearest_in_box(body.bounds_B, p_B)).norm();
  if (body.voxels->voxmap.layer_at(p_B) <= 0) return 0;
  const Pointshell& shell = body.voxels->shell;
  const Vector3f p = (p_B - shell.reference).cast<float>();
  float nearest = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < shell.size(); ++i)
    nearest = std::min(nearest, (Vector3f(shell.x[i], shell.y[i], shell.z[i]) - p).squaredNorm());
  return std::sqrt(static_cast<double>(nearest));
}

/// @pre hand.handle_before is up to date
Sight seen_by(const World& world, const Hand& hand) {
  const bool holds = hand.body != kNone;
  return {hand.handle_before, holds ? world.bodies[hand.body].rigid.pose() : Pose(), holds};
}

}  // namespace

void Grasping::sample(World& world) {
  for (Hand& hand : world.hands) {
    Device& device = *hand.device;
    hand.handle_before = device.reading().handle;
    device.sample({world.frame, world.time(), world.dt, hand.collisions, hand.collision_starts, seen_by(world, hand)});
    const Pose& handle = device.reading().handle;
    if (!handle.position.allFinite() || !handle.rotation.coeffs().allFinite())
      fail(ErrorKind::diverged, "frame {}: the handle of device '{}' is not finite", world.frame, device.name());
    if (world.frame == 0) hand.handle_before = handle;
  }
}

std::size_t Grasping::nearest_body(const World& world, const Vector3d& p_W) const {
  std::size_t best = kNone;
  double best_distance = distance_;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    if (!body.can_move || !body.selectable || body.held_by != kNone) continue;
    const Vector3d p_B = body.rigid.pose().inverse() * p_W;
    if ((p_B - nearest_in_box(body.bounds_B, p_B)).norm() > best_distance) continue;
    const double d = distance_to(body, p_W);
    if (d < best_distance || (d == best_distance && best == kNone)) {
      best = i;
      best_distance = d;
    }
  }
  return best;
}

void Grasping::update(World& world, Notes& notes) {
  for (const Grasp& grasp : first_grasps_) take(world, grasp.device, grasp.body, true, notes);
  first_grasps_.clear();
  for (std::size_t h = 0; h < world.hands.size(); ++h) {
    const Hand& hand = world.hands[h];
    const DeviceReading& reading = hand.device->reading();
    if (hand.by_script) continue;
    if (hand.body != kNone && !reading.button) let_go(world, h, notes);
    if (hand.body == kNone && reading.button && hand.device->driven()) {
      const std::size_t body = nearest_body(world, reading.handle.position);
      if (body != kNone) take(world, h, body, false, notes);
    }
  }
}

void Grasping::take(World& world, std::size_t h, std::size_t index, bool by_script, Notes& notes) {
  VERISIM_ASSERT(h < world.hands.size());
  VERISIM_ASSERT(index < world.bodies.size());
  Hand& hand = world.hands[h];
  Body& body = world.bodies[index];
  if (hand.body != kNone) let_go(world, h, notes);
  if (body.held_by != kNone) let_go(world, body.held_by, notes);
  hand.body = index;
  hand.by_script = by_script;
  hand.X_HB = hand.device->reading().handle.inverse() * body.rigid.pose();
  body.held_by = h;
  world.holds_changed = true;
  notes.add({.time = world.time(), .kind = "grasp", .text = text_of_grasp, .first = h, .second = index});
}

void Grasping::let_go(World& world, std::size_t h, Notes& notes) {
  VERISIM_ASSERT(h < world.hands.size());
  Hand& hand = world.hands[h];
  if (hand.body == kNone) return;
  const std::size_t index = hand.body;
  Body& body = world.bodies[index];
  body.held_by = kNone;
  world.holds_changed = true;
  hand.body = kNone;
  hand.by_script = false;
  if (!world.parameters.all_bodies_are_dynamic) body.rigid.v_C = body.rigid.omega = Vector3d::Zero();
  notes.add({.time = world.time(), .kind = "release", .text = text_of_release, .first = h, .second = index});
}

CouplingTarget target_of(const World& world, std::size_t h) {
  const Hand& hand = world.hands[h];
  VERISIM_ASSERT(hand.body != kNone);
  const RigidBody& rigid = world.bodies[hand.body].rigid;
  const Pose now = hand.device->reading().handle * hand.X_HB;
  const Pose before = hand.handle_before * hand.X_HB;
  CouplingTarget target;
  target.p_WC = now * rigid.p_BC;
  target.R_WB = now.rotation;
  target.v_C = (target.p_WC - before * rigid.p_BC) / world.dt;
  target.omega = vector_from_rotation(now.rotation * before.rotation.conjugate()) / world.dt;
  return target;
}

}  // namespace verisim
