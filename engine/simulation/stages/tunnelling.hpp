// Tells of bodies that move so fast that contacts cannot be relied on: farther in a step than the body is thick along
// its motion (the box around its mesh, seen from there). Between two frames it can then have passed through another
// body. Spin is not looked at: a thing that only turns stays where it is. Where voxels answer, half of the thickness of
// what is met is enough: beyond its middle they push out on the other side. `exact` looks ahead.
#pragma once

#include <vector>

#include "engine/simulation/stages/notes.hpp"
#include "engine/simulation/stages/pair_methods.hpp"
#include "engine/simulation/world.hpp"

namespace verisim {

class Tunnelling {
 public:
  explicit Tunnelling(const World& world) : told_(world.bodies.size(), false), told_of_(world.bodies.size(), false) {}

  /// After a step: notes the first time that a body does so, and the first time that another does so to it.
  void watch(const World& world, const PairMethods& methods, Notes& notes);

 private:
  void watch_pairs(const World& world, const PairMethods& methods, Notes& notes);
  std::vector<bool> told_, told_of_;
};

}  // namespace verisim
