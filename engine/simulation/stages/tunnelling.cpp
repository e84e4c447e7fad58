#include "engine/simulation/stages/tunnelling.hpp"

#include <fmt/format.h>

#include <utility>

namespace verisim {

namespace {

std::string text_of_fast(const World& world, const Note& note) {
  return fmt::format(
      "'{}' moves farther in a step ({:.3g} m) than it is thick ({:.3g} m): it may pass through others "
      "unseen; use a smaller timestep",
      world.bodies[note.first].name, note.a, note.b);
}

std::string text_of_thin(const World& world, const Note& note) {
  return fmt::format(
      "'{}' moves {:.3g} m in a step to '{}', which is {:.3g} m thick there: its voxels may let it pass; use a smaller "
      "timestep, or hybrid = \"exact\"",
      world.bodies[note.second].name, note.a, world.bodies[note.first].name, note.b);
}

/// How thick the box around a body is along v, times |v| [m^2/s].
double thickness_times_speed(const Body& body, const Vector3d& v) {
  return (body.rigid.R_WB.conjugate() * v).cwiseAbs().dot(body.bounds_B.size());
}

}  // namespace

void Tunnelling::watch(const World& world, const PairMethods& methods, Notes& notes) {
  for (const std::size_t i : world.moving) {
    const Body& body = world.bodies[i];
    if (told_[i]) continue;
    const Vector3d& v = body.rigid.v_C;
    // Its thickness along v is this over |v|.
    const double thickness_v = thickness_times_speed(body, v);
    if (!(world.dt * v.squaredNorm() > thickness_v)) continue;
    told_[i] = true;
    notes.add({.time = world.time(),
               .kind = "tunnelling",
               .text = text_of_fast,
               .first = i,
               .a = world.dt * v.norm(),
               .b = thickness_v / v.norm()});
  }
  watch_pairs(world, methods, notes);
}

void Tunnelling::watch_pairs(const World& world, const PairMethods& methods, Notes& notes) {
  constexpr double kMiddle = 0.5;
  for (const std::size_t l : world.near_links) {
    if (!methods.needs_voxels(l)) continue;
    const Link& link = world.links[l];
    const auto velocity = [&](std::size_t i) {
      return world.moves(world.bodies[i]) ? world.bodies[i].rigid.v_C : Vector3d(Vector3d::Zero());
    };
    const Vector3d v = velocity(link.first) - velocity(link.second);
    for (const auto& [thin, other] : {std::pair(link.first, link.second), std::pair(link.second, link.first)}) {
      const double thickness_v = thickness_times_speed(world.bodies[thin], v);
      if (told_of_[thin] || !(world.dt * v.squaredNorm() > kMiddle * thickness_v)) continue;
      told_of_[thin] = true;
      notes.add({.time = world.time(),
                 .kind = "tunnelling",
                 .text = text_of_thin,
                 .first = thin,
                 .second = other,
                 .a = world.dt * v.norm(),
                 .b = thickness_v / v.norm()});
    }
  }
}

}  // namespace verisim
