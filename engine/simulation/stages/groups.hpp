// Bodies that some of their links join.
#pragma once

#include <algorithm>

#include "engine/simulation/world.hpp"

namespace verisim {

/// Writes for every body the number of the first body of those that the links joined it to, its own if none did.
/// `joins(link)` says of a near link whether it does. Costs about busy bodies + near links: of others nothing is
/// written.
template <typename Joins>
void join_bodies(const World& world, std::vector<std::size_t>& group, const Joins& joins) {
  for (const std::size_t i : world.busy) group[i] = i;
  const auto first_of = [&](std::size_t i) {
    while (group[i] != i) i = group[i];
    return i;
  };
  for (const std::size_t l : world.near_links) {
    if (!joins(l)) continue;
    const Link& link = world.links[l];
    VERISIM_ASSERT(link.second < group.size());
    const auto [low, high] = std::minmax({first_of(link.first), first_of(link.second)});
    group[high] = low;
  }
  for (const std::size_t i : world.busy) group[i] = group[group[i]];  // low before high: that one is final
}

}  // namespace verisim
