// Bodies that some of their links join. Private to this folder.
#pragma once

#include <algorithm>

#include "engine/simulation/world.hpp"

namespace verisim {

/// Writes into every body's `group` the number of the first body of those that the links joined it to, its own if none
/// did. `joins` says of a link whether it does. Costs about bodies + links.
template <typename Joins>
void join_bodies(std::vector<Body>& bodies, const std::vector<Link>& links, std::size_t Body::*group, Joins joins) {
  for (std::size_t i = 0; i < bodies.size(); ++i) bodies[i].*group = i;
  const auto first_of = [&](std::size_t i) {
    while (bodies[i].*group != i) i = bodies[i].*group;
    return i;
  };
  for (const Link& link : links) {
    if (!joins(link)) continue;
    const auto [low, high] = std::minmax({first_of(link.first), first_of(link.second)});
    bodies[high].*group = low;
  }
  for (Body& body : bodies) body.*group = bodies[body.*group].*group;  // low before high: that one is final
}

}  // namespace verisim
