#include "engine/simulation/stages/sinking.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace verisim {

namespace {

/// m: of surfaces. As much, and a light body is squeezed out from between heavy ones. Nor are they looked for deeper
/// than a voxel.
constexpr double kGivesWay = 5e-5;

std::string text_of_sinking(const World& world, const Note& note) {
  return fmt::format(
      "'{}' weighs {:.3g} N and sinks, {:.3g} mm by now: the contacts of its voxels are too soft; raise "
      "contactStiffness "
      "(now {:.3g} N/m) with integrator = \"implicit\", or lower its density",
      world.bodies[note.first].name, note.a, 1e3 * note.b, world.parameters.contact_stiffness);
}

/// Its weight alone moves a body farther in a step than a contact of voxels is deep: no stiffness helps.
bool is_step_too_long(const World& world, double voxel) {
  return world.parameters.gravity.norm() * world.dt * world.dt > 0.5 * voxel;
}

std::string text_of_long_steps(const World& world, const Note& note) {
  const double falls = world.parameters.gravity.norm() * world.dt * world.dt;
  return fmt::format(
      "'{}' sinks, {:.3g} mm by now: in a step of {:g} s its weight moves it by {:.3g} mm, over half a voxel; use a "
      "timestep below {:.2g} s or larger voxels",
      world.bodies[note.first].name, 1e3 * note.b, world.dt, 1e3 * falls,
      std::sqrt(0.5 * note.a / world.parameters.gravity.norm()));
}

std::string text_of_exact_sinking(const World& world, const Note& note) {
  return fmt::format(
      "'{}' weighs {:.3g} N and sinks, {:.3g} mm by now: the contacts of its surfaces are too soft; raise "
      "exactStiffness (now {:.3g} N/m^2), or lower its density",
      world.bodies[note.first].name, note.a, 1e3 * note.b, world.parameters.exact_stiffness);
}

}  // namespace

void Sinking::watch(const World& world, const Contacts& contacts, const ExactResponse& exact,
                    const Reactions& reactions, Notes& notes) {
  const SimulationParameters& p = world.parameters;
  if (!p.all_bodies_are_dynamic || p.gravity.isZero(0)) return;
  for (const std::size_t l : world.near_links) {
    const bool by_surfaces = exact.count(l) > 0;
    if ((!contacts.touches(l) && !by_surfaces) || exact.parts(l)) continue;
    const auto [first, second, number] = world.links[l];
    const double voxel = std::max(world.bodies[first].voxel_size, world.bodies[second].voxel_size);
    const double depth = by_surfaces ? exact.depth_max(l) : contacts.depth_max(l);
    if (!(depth > (by_surfaces ? std::min(0.5 * voxel, kGivesWay) : voxel))) continue;
    const auto text = by_surfaces ? text_of_exact_sinking : text_of_sinking;
    watch(world, first, depth, text, reactions, notes);
    watch(world, second, depth, text, reactions, notes);
  }
}

void Sinking::watch(const World& world, std::size_t i, double depth, Text text, const Reactions& reactions,
                    Notes& notes) {
  const Body& body = world.bodies[i];
  if (told_[i] || !world.moves(body) || body.held_by != kNone) return;
  const Vector3d& g = world.parameters.gravity;
  const double weight = body.rigid.mass * g.norm();
  const bool falls = body.rigid.v_C.dot(g) > 0;
  if (!falls || !(-reactions.on_body(i).force.dot(g) < weight * g.norm())) return;
  told_[i] = true;
  const bool step = text == text_of_sinking && is_step_too_long(world, body.voxel_size);
  notes.add({.time = world.time(),
             .kind = "sinking",
             .text = step ? text_of_long_steps : text,
             .first = i,
             .a = step ? body.voxel_size : weight,
             .b = depth});
}

}  // namespace verisim
