// A large assembly in which three hands move one part each, down onto a plate: 0.06 m boxes, 5 mm voxels. The others
// lie beside it, where nothing comes near them.
#pragma once

#include "tests/simulation/scenes.hpp"

namespace verisim::scenes {

/// @param others  how many parts stand besides the three; as fixed ones, or such that a hand could take
inline Scene three_move_among(int others, bool fixed) {
  Scene scene = falling_boxes(3, Integrator::semi_implicit);
  for (int i = 0; i < others; ++i) {
    // What a hand could take is voxelized at once. Of fixed ones the size shows whether they are: none takes it.
    const double voxel_size = fixed ? -1 : 0.005;
    BodyDescription part = body_of("part" + std::to_string(i), centred_box({0.05, 0.05, 0.05}), voxel_size);
    part.fixed = fixed;
    part.X_WB.position = {2 + 0.2 * (i % 20), 0.2 * (i / 20), -5};
    scene.bodies.push_back(std::move(part));
  }
  scene.parameters.all_bodies_are_dynamic = false;
  for (std::size_t i = 1; i <= 3; ++i) {
    const Pose& start = scene.bodies[i].X_WB;
    HandDescription hand;
    hand.name = "hand" + std::to_string(i);
    hand.path = {{start}, {{start.position - Vector3d(0, 0, 0.03), start.rotation}, 0.2}};
    scene.devices.push_back(make_hand(hand));
    scene.grasps.push_back({i - 1, i});
  }
  return scene;
}

}  // namespace verisim::scenes
