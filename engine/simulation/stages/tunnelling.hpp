// Tells of bodies that move so fast that contacts cannot be relied on: farther in a step than the body is thick along
// its motion (the box around its mesh, seen from there). Between two frames it can then have passed through another
// body. Spin is not looked at: a thing that only turns stays where it is.
#pragma once

#include <vector>

#include "engine/simulation/stages/notes.hpp"
#include "engine/simulation/world.hpp"

namespace verisim {

class Tunnelling {
 public:
  explicit Tunnelling(const World& world) : told_(world.bodies.size(), false) {}

  /// After a step: notes the first time that a body does so.
  void watch(const World& world, Notes& notes);

 private:
  std::vector<bool> told_;
};

}  // namespace verisim
