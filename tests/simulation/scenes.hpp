// Small scenes made without files or a CAD kernel: parts straight from meshes, so that a test carries what it needs.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/device/sources.hpp"
#include "engine/simulation/simulation.hpp"
#include "tests/voxel/shapes.hpp"

namespace verisim::scenes {

inline Part part_of(std::string name, TriangleMesh mesh) {
  Part part;
  part.name = std::move(name);
  part.mass = mass_properties_of(mesh);
  part.area = area_of(mesh);
  part.mesh = std::move(mesh);
  part.watertight = true;
  return part;
}

inline BodyDescription body_of(const std::string& name, TriangleMesh mesh, double voxel_size) {
  BodyDescription body;
  body.name = name;
  body.parts.push_back(part_of(name, std::move(mesh)));
  body.voxel_size = voxel_size;
  return body;
}

inline TriangleMesh centred_box(const Vector3d& size) {
  return shapes::box(-0.5 * size, 0.5 * size);
}

/// An operator whose targets are straight legs between `positions`.
inline std::shared_ptr<Device> hand_along(const std::vector<Vector3d>& positions, double speed, double tremor = 0) {
  HandDescription hand;
  hand.name = "hand";
  hand.tremor = tremor;
  for (const Vector3d& p : positions) hand.path.push_back({Pose{p, Quaterniond::Identity()}, speed, 0.05});
  return make_hand(hand);
}

/// A light pin driven into the hole of a fixed block and out again: 4.5 mm voxels, the dissertation's sizes halved.
inline Scene pin_in_hole() {
  Scene scene;
  scene.parameters.duration = 1.2;
  BodyDescription block = body_of("block", shapes::block_with_hole({0.375, 0.375, 0.1}, 0.075, 48), 0.0045);
  block.fixed = true;
  BodyDescription pin = body_of("pin", shapes::cylinder(0.07, 0.2, 48), 0.0045);  // from z = 0 to 0.2
  pin.density = 10;
  pin.X_WB.position = {0.002, 0, 0.08};
  scene.bodies = {std::move(block), std::move(pin)};
  scene.devices = {hand_along({{0.002, 0, 0.1}, {0.002, 0.001, -0.1}, {0.002, 0, 0.1}}, 0.5, 0.0005)};
  scene.grasps = {{0, 1}};
  return scene;
}

/// Boxes falling on a plate: everything moves, nobody holds anything.
inline Scene falling_boxes(int count, Integrator integrator) {
  Scene scene;
  scene.parameters.gravity = {0, 0, -9.81};
  scene.parameters.all_bodies_are_dynamic = true;
  scene.parameters.integrator = integrator;
  scene.parameters.duration = 0.5;
  BodyDescription plate = body_of("plate", centred_box({0.3, 0.3, 0.02}), 0.005);
  plate.fixed = true;
  scene.bodies.push_back(std::move(plate));
  for (int i = 0; i < count; ++i) {
    BodyDescription box = body_of("box" + std::to_string(i), centred_box({0.06, 0.06, 0.06}), 0.005);
    box.density = 500;
    box.X_WB.position = {0.001 * i, 0, 0.05 + 0.07 * i};
    scene.bodies.push_back(std::move(box));
  }
  return scene;
}

}  // namespace verisim::scenes
