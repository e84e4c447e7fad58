#include "engine/simulation/stages/tunnelling.hpp"

#include <fmt/format.h>

namespace verisim {

namespace {

std::string text_of_fast(const World& world, const Note& note) {
  return fmt::format(
      "'{}' moves farther in a step ({:.3g} m) than it is thick ({:.3g} m): it may pass through others "
      "unseen; use a smaller timestep",
      world.bodies[note.first].name, note.a, note.b);
}

}  // namespace

void Tunnelling::watch(const World& world, Notes& notes) {
  for (const std::size_t i : world.moving) {
    const Body& body = world.bodies[i];
    if (told_[i]) continue;
    const Vector3d& v = body.rigid.v_C;
    // Its thickness along v is this over |v|.
    const double thickness_v = (body.rigid.R_WB.conjugate() * v).cwiseAbs().dot(body.bounds_B.size());
    if (!(world.dt * v.squaredNorm() > thickness_v)) continue;
    told_[i] = true;
    notes.add({.time = world.time(),
               .kind = "tunnelling",
               .text = text_of_fast,
               .first = i,
               .a = world.dt * v.norm(),
               .b = thickness_v / v.norm()});
  }
}

}  // namespace verisim
