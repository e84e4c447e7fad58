// Tells of bodies that are too heavy for the stiffness of their contacts, of voxels or of surfaces. A body that nobody
// holds sinks if its contacts push it up with less than its weight when it is already deeper than a voxel (by surfaces:
// half of one): at rest it would be deeper still, and behind the last layer of voxels there is nothing.
// Where its weight moves it by half a voxel within a step it is the step that is too long, and the event says so.
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
  void watch(const World& world, const Contacts& contacts, const ExactResponse& exact, const Reactions& reactions,
             Notes& notes);

 private:
  using Text = std::string (*)(const World& world, const Note& note);
  void watch(const World& world, std::size_t body, double depth, Text text, const Reactions& reactions, Notes& notes);

  std::vector<bool> told_;
};

}  // namespace verisim
