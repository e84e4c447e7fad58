// The dissertation's block and pin as entities and feature sets, without voxels: what the hybrid method is given.
#pragma once

#include "tests/constraint/shapes.hpp"

namespace verisim::test {

/// Sets by name. The order is that of the lists below.
namespace block_set {
enum : FeatureSetId { nothing, wall, top, rim };
}
namespace pin_set {
enum : FeatureSetId { nothing, side, end, edge };
}

/// A hole of radius 75 mm along z through a block from z = -0.1 to 0.1: wall 0, top 1, rim 2.
inline EntitySets block_with_hole(double radius = 0.075) {
  const std::vector<std::vector<std::uint32_t>> sets = {{}, {0}, {1}, {0, 1, 2}};
  return {std::vector<Entity>{cylinder(radius, true), plane(kZ, {0, 0, 0.1}), circle(radius, Role::hole, {0, 0, 0.1})},
          sets};
}

/// A pin of radius 70 mm from z = -0.2 to 0.2: side 0, lower end 1, its edge 2.
inline EntitySets pin(double radius = 0.070) {
  const std::vector<std::vector<std::uint32_t>> sets = {{}, {0}, {1}, {0, 1, 2}};
  return {std::vector<Entity>{cylinder(radius, false, 0.2), plane(-kZ, {0, 0, -0.2}),
                              circle(radius, Role::pin, {0, 0, -0.2})},
          sets};
}

/// A stepped pin that hangs in the hole by its collar: side 0 below the collar's underside 1, and their (inner) edge 2
/// at z = 0.
inline EntitySets collared_pin() {
  const std::vector<std::vector<std::uint32_t>> sets = {{}, {0}, {1}, {0, 1, 2}};
  return {std::vector<Entity>{cylinder(0.070, false, 0.1, {0, 0, -0.1}), plane(-kZ), circle(0.070, Role::pin)}, sets};
}

}  // namespace verisim::test
