#include "engine/simulation/stages/pair_methods.hpp"

#include "engine/base/error.hpp"

namespace verisim {
namespace {

std::unique_ptr<PairMethod> make(const World& world, const Link& link, const Contacts& contacts, std::size_t l,
                                 std::vector<Event>& events) {
  const Body& first = world.bodies[link.first];
  const Body& second = world.bodies[link.second];
  const Hybrid method = lesser(first.method, second.method);
  if (contacts.link(l) == nullptr || !method->needs_entities()) return nullptr;
  if (!first.entities || !second.entities) {
    if (first.entities || second.entities)
      events.push_back({0, "hybrid",
                        fmt::format("'{}' has no b-rep: its contacts with '{}' stay with the voxels",
                                    (first.entities ? second : first).name, (first.entities ? first : second).name)});
    return nullptr;
  }
  return method->make({world.parameters, first, second, *contacts.link(l)});
}

}  // namespace

PairMethods::PairMethods(const World& world, const Contacts& contacts, std::vector<Event>& events)
    : acting_(world.links.size(), nullptr) {
  for (std::size_t l = 0; l < world.links.size(); ++l) {
    methods_.push_back(make(world, world.links[l], contacts, l, events));
    any_precise_ = any_precise_ || (methods_.back() && methods_.back()->precise() != nullptr);
  }
}

void PairMethods::choose(const World& world) {
  for (std::size_t l = 0; l < methods_.size(); ++l) {
    const auto [first, second] = world.links[l];
    const bool enabled = world.bodies[first].hybrid_enabled && world.bodies[second].hybrid_enabled;
    acting_[l] = enabled ? methods_[l].get() : nullptr;
    if (acting_[l] != nullptr) acting_[l]->begin_frame();
  }
}

}  // namespace verisim
