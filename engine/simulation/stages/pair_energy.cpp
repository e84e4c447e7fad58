#include "engine/simulation/stages/pair_energy.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/simulation/stages/energy.hpp"

namespace verisim {
namespace {

double work_on(const World& world, std::size_t body, const Wrench& wrench, const Motion& motion) {
  if (!world.moves(world.bodies[body])) return 0;
  const Vector6d& moved = motion.work(body).moved;
  return wrench.force.dot(moved.head<3>()) + wrench.torque.dot(moved.tail<3>());
}

double energy_of_body(const World& world, const Body& body) {
  if (!world.moves(body)) return 0;
  return body.rigid.kinetic_energy() + spring_energy_of(world, body);
}

std::string text_of_created(const World& world, const Note& note, const std::string& remedy) {
  return fmt::format(
      "contacts of '{}' and '{}' gave {:.3g} J in a step that nobody had given them, of {:.3g} J that "
      "both have; {} or use a smaller timestep",
      world.bodies[note.first].name, world.bodies[note.second].name, note.a, note.b, remedy);
}
std::string text_of_voxels(const World& world, const Note& note) {
  return text_of_created(world, note, "use smaller voxels");
}
std::string text_of_surfaces(const World& world, const Note& note) {
  return text_of_created(world, note,
                         fmt::format("raise exactStiffness (now {:.3g} N/m^2)", world.parameters.exact_stiffness));
}

}  // namespace

void PairEnergy::watch(const World& world, const Contacts& contacts, const ExactResponse& exact,
                       const Reactions& reactions, const Motion& motion, Notes& notes) {
  for (const std::size_t l : world.near_links) {
    OfLink& of = links_[l];
    if (!contacts.touches(l) && exact.count(l) == 0) continue;
    if (of.touched_in + 1 != world.frame) of.given = 0;
    of.touched_in = world.frame;
    const auto [first, second, number] = world.links[l];
    const double before = std::max(0.0, of.given);
    of.given +=
        work_on(world, first, reactions.on_first(l), motion) + work_on(world, second, reactions.on_second(l), motion);
    const double created = std::max(0.0, of.given) - before;
    if (of.told || !(created > kLeast)) continue;
    const double energy = energy_of_body(world, world.bodies[first]) + energy_of_body(world, world.bodies[second]);
    if (!(created > kFraction * energy)) continue;
    of.told = true;
    notes.add({.time = world.time(),
               .kind = "energy",
               .text = contacts.touches(l) ? text_of_voxels : text_of_surfaces,
               .first = first,
               .second = second,
               .a = created,
               .b = energy});
  }
}

}  // namespace verisim
