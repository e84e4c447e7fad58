#include "engine/simulation/stages/reactions.hpp"

namespace verisim {
namespace {

/// One side of a link: what its voxels' contacts were at the start of the step, and how the step ended for the body.
struct SideOfLink {
  const LinkSide& start;
  const Body& body;
  const ContactEnd& end;
  const Vector3d& found_at;
  bool solved;  ///< by the exact response
};

/// What the voxels' contacts of a link did to one of its bodies. Between two that move they acted as at the start. To
/// one that stands still they did what the reaction is of what they did to the other; where both stand still, what they
/// would have done.
Wrench applied(const World& world, const SideOfLink& mine, const SideOfLink& theirs) {
  const auto on = [&](const LinkSide& side, const ContactEnd& end) {
    return wrench_at_end(side.wrench, side.stiffness, side.damping, side.drift, end, world.dt);
  };
  if (world.moves(mine.body) && world.moves(theirs.body)) {
    const double scale = mine.end.mutual_scale;
    return {scale * mine.start.wrench.force, scale * mine.start.wrench.torque};
  }
  if (world.moves(mine.body)) return on(mine.start, mine.end);
  if (!world.moves(theirs.body)) return mine.start.wrench;
  const bool at_start = !world.is_implicit() && !theirs.solved;
  return at_start ? on(mine.start, theirs.end) : reaction(on(theirs.start, theirs.end), theirs.found_at, mine.found_at);
}

}  // namespace

void Reactions::find(const World& world, const Contacts& contacts, const Response& response, const ExactResponse& exact,
                     const Motion& motion) {
  for (const std::size_t i : world.busy) on_body_[i] = world.moves(world.bodies[i]) ? motion.work(i).contact : Wrench{};
  for (const std::size_t l : world.near_links) {
    const auto [i, j, number] = world.links[l];
    const Body& first = world.bodies[i];
    const Body& second = world.bodies[j];
    on_second_[l] = exact.on_second(l);
    on_first_[l] = reaction(on_second_[l], contacts.found_at(j), contacts.found_at(i));
    if (contacts.touches(l)) {
      const LinkSides& sides = response.sides(l);
      const SideOfLink one{sides.first, first, motion.work(i).contact_end, contacts.found_at(i), exact.solved(i)};
      const SideOfLink two{sides.second, second, motion.work(j).contact_end, contacts.found_at(j), exact.solved(j)};
      on_first_[l] += applied(world, one, two);
      on_second_[l] += applied(world, two, one);
    }
    if (!world.moves(first)) on_body_[i] += on_first_[l];
    if (!world.moves(second)) on_body_[j] += on_second_[l];
  }
}

}  // namespace verisim
