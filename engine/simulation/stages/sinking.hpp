// Tells of bodies that are too heavy for the stiffness of their voxels' contacts. A body that nobody holds sinks if its
// contacts push it up with less than its weight when it is already deeper than a voxel: at rest it would be deeper
// still, and behind the last layer of voxels there is nothing.
#pragma once

#include <vector>

#include "engine/simulation/stages/notes.hpp"
#include "engine/simulation/stages/reactions.hpp"
#include "engine/simulation/world.hpp"

namespace verisim {

class Sinking {
 public:
  explicit Sinking(const World& world) : told_(world.bodies.size(), false) {}

  /// After a step: notes the first time that a body does so.
  void watch(const World& world, const Contacts& contacts, const Reactions& reactions, Notes& notes);

 private:
  void watch(const World& world, std::size_t body, double depth, const Reactions& reactions, Notes& notes);

  std::vector<bool> told_;
};

}  // namespace verisim
