#include "engine/simulation/stages/passivity.hpp"

#include <algorithm>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/simulation/stages/groups.hpp"

namespace verisim {

Passivity::Passivity(const World& world)
    : watched_(world.bodies.size(), false),
      unbounded_(world.bodies.size(), false),
      group_(world.bodies.size()),
      work_(world.bodies.size()),
      scale_(world.bodies.size(), 1) {}

bool Passivity::watch_links(const World& world, const Contacts& contacts, const PairMethods& methods) {
  for (const std::size_t i : world.busy) watched_[i] = false;
  bool any = false;
  for (const std::size_t l : world.near_links) {
    const bool touches = contacts.touches(l);
    const bool before = watched_in_[l] != kNone && watched_in_[l] + 1 == world.frame;
    if (methods.acting(l) == nullptr && !(before && touches)) continue;
    watched_in_[l] = world.frame;
    if (!touches) continue;
    watched_[world.links[l].first] = watched_[world.links[l].second] = true;
    any = true;
  }
  return any;
}

void Passivity::bound(const World& world, const Contacts& contacts, const PairMethods& methods,
                      const Response& response, const ExactResponse& exact, const Ledger& ledger) {
  for (const std::size_t i : world.busy) scale_[i] = 1;
  if (!watch_links(world, contacts, methods) || !world.parameters.passive_contacts) return;
  const auto moves = [&](std::size_t i) { return world.moves(world.bodies[i]); };
  join_bodies(world, group_, [&](std::size_t l) {
    return contacts.touches(l) && moves(world.links[l].first) && moves(world.links[l].second);
  });
  bound_groups(world, response, exact, ledger.contact());
}

void Passivity::bound_groups(const World& world, const Response& response, const ExactResponse& exact, double budget) {
  for (const std::size_t i : world.busy) work_[i] = {};
  for (const std::size_t i : world.busy)
    if (watched_[i]) watched_[group_[i]] = true;
  for (const std::size_t i : world.busy) unbounded_[i] = false;
  for (const std::size_t i : world.busy)
    if (exact.solved(i)) unbounded_[group_[i]] = true;
  for (const std::size_t i : world.busy) {
    const Body& body = world.bodies[i];
    if (!watched_[group_[i]] || !world.moves(body) || exact.solved(i)) continue;
    work_[group_[i]] += world.is_implicit() ? contact_work_implicit(body.rigid, response.loads(i), world.dt)
                                            : contact_work_semi_implicit(body.rigid, response.loads(i), world.dt);
  }
  for (const std::size_t i : world.busy) {
    if (group_[i] == i && watched_[i]) {
      scale_[i] = unbounded_[i] ? 1 : passive_scale(std::max(0.0, budget), work_[i]);
      VERISIM_ASSERT(is_fraction(scale_[i]));
      budget -= work_[i].at(scale_[i]);
    }
    scale_[i] = scale_[group_[i]];
  }
}

}  // namespace verisim
