#include "engine/simulation/stages/pair_methods.hpp"

#include "engine/base/error.hpp"
#include "engine/simulation/known_surface.hpp"

namespace verisim {

void PairMethods::add_link(const World& world, const Contacts& contacts, std::size_t l) {
  VERISIM_ASSERT(l == of_.size());
  const Body& first = world.bodies[world.links[l].first];
  const Body& second = world.bodies[world.links[l].second];
  const Hybrid method = lesser(first.method, second.method);
  const bool acts = method->needs_entities() && first.entities && second.entities;
  OfPair& of = of_.emplace_back();
  if (acts) of.method = method->make({world.parameters, first, second, contacts.link(l)});
  if (of.method == nullptr) return;
  of.precise = of.method->precise();
  of.needs_voxels = of.method->needs_voxels();
}

Hybrid PairMethods::asked_of(const World& world, std::size_t l) {
  return lesser(world.bodies[world.links[l].first].method, world.bodies[world.links[l].second].method);
}

void PairMethods::tell(const World& world, std::size_t l, std::vector<Event>& events) {
  const Body& first = world.bodies[world.links[l].first];
  const Body& second = world.bodies[world.links[l].second];
  const Hybrid asked = asked_of(world, l);
  if (!asked->needs_entities()) return;
  const auto say = [&](const std::string& text) { events.push_back({world.time(), "hybrid", text}); };
  if (!first.entities && !second.entities) {
    say(fmt::format("'{}' and '{}' have no b-rep: their contacts stay with the voxels", first.name, second.name));
  } else if (!first.entities || !second.entities) {
    say(fmt::format("'{}' has no b-rep: its contacts with '{}' stay with the voxels",
                    (first.entities ? second : first).name, (first.entities ? first : second).name));
  } else if (const std::string gaps = gaps_of(first, second, asked); !gaps.empty()) {
    say(fmt::format("{}: contacts of '{}' and '{}' there stay with the voxels", gaps, first.name, second.name));
  }
}

bool PairMethods::is_switched_off(const World& world, std::size_t l) {
  const Link& link = world.links[l];
  return !world.bodies[link.first].hybrid_enabled || !world.bodies[link.second].hybrid_enabled;
}

void PairMethods::choose(const World& world) {
  for (const std::size_t l : world.near_links) {
    OfPair& of = of_[l];
    of.acts = of.method != nullptr && !is_switched_off(world, l);
    if (of.acts && of.needs_voxels) of.method->begin_frame();
  }
}

}  // namespace verisim
