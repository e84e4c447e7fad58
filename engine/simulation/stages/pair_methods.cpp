#include "engine/simulation/stages/pair_methods.hpp"

#include "engine/base/error.hpp"

namespace verisim {

void PairMethods::add_link(const World& world, const Contacts& contacts, std::size_t l) {
  VERISIM_ASSERT(l == methods_.size());
  const Body& first = world.bodies[world.links[l].first];
  const Body& second = world.bodies[world.links[l].second];
  const Hybrid method = lesser(first.method, second.method);
  const bool acts = method->needs_entities() && first.entities && second.entities;
  methods_.push_back(acts ? method->make({world.parameters, first, second, contacts.link(l)}) : nullptr);
  acting_.push_back(nullptr);
}

void PairMethods::tell(const World& world, std::size_t l, std::vector<Event>& events) {
  const Body& first = world.bodies[world.links[l].first];
  const Body& second = world.bodies[world.links[l].second];
  const bool both_or_none = static_cast<bool>(first.entities) == static_cast<bool>(second.entities);
  if (!lesser(first.method, second.method)->needs_entities() || both_or_none) return;
  events.push_back({world.time(), "hybrid",
                    fmt::format("'{}' has no b-rep: its contacts with '{}' stay with the voxels",
                                (first.entities ? second : first).name, (first.entities ? first : second).name)});
}

void PairMethods::choose(const World& world) {
  for (const std::size_t l : world.near_links) {
    const auto [first, second, number] = world.links[l];
    const bool enabled = world.bodies[first].hybrid_enabled && world.bodies[second].hybrid_enabled;
    acting_[l] = enabled ? methods_[l].get() : nullptr;
    if (acting_[l] != nullptr) acting_[l]->begin_frame();
  }
}

}  // namespace verisim
