#include "engine/simulation/stages/sinking.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace verisim {

namespace {

std::string text_of_sinking(const World& world, const Note& note) {
  return fmt::format(
      "'{}' weighs {:.3g} N and sinks, {:.3g} mm by now: the contacts of its voxels are too soft; raise "
      "contactStiffness "
      "(now {:.3g} N/m) with integrator = \"implicit\", or lower its density",
      world.bodies[note.first].name, note.a, 1e3 * note.b, world.parameters.contact_stiffness);
}

}  // namespace

void Sinking::watch(const World& world, const Contacts& contacts, const Reactions& reactions, Notes& notes) {
  const SimulationParameters& p = world.parameters;
  if (!p.all_bodies_are_dynamic || p.gravity.isZero(0)) return;
  for (const std::size_t l : world.near_links) {
    if (!contacts.touches(l)) continue;
    const auto [first, second, number] = world.links[l];
    const double voxel = std::max(world.bodies[first].voxel_size, world.bodies[second].voxel_size);
    const double depth = contacts.depth_max(l);
    if (!(depth > voxel)) continue;
    watch(world, first, depth, reactions, notes);
    watch(world, second, depth, reactions, notes);
  }
}

void Sinking::watch(const World& world, std::size_t i, double depth, const Reactions& reactions, Notes& notes) {
  const Body& body = world.bodies[i];
  if (told_[i] || !world.moves(body) || body.held_by != kNone) return;
  const Vector3d& g = world.parameters.gravity;
  const double weight = body.rigid.mass * g.norm();
  const bool falls = body.rigid.v_C.dot(g) > 0;
  if (!falls || !(-reactions.on_body(i).force.dot(g) < weight * g.norm())) return;
  told_[i] = true;
  notes.add({.time = world.time(), .kind = "sinking", .text = text_of_sinking, .first = i, .a = weight, .b = depth});
}

}  // namespace verisim
