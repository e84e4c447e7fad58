// Scenes whose bodies have exact b-reps, for the hybrid methods: made from solids by the CAD kernel.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/geometry/loader.hpp"
#include "tests/simulation/scenes.hpp"

namespace verisim::scenes {

inline std::shared_ptr<const Solid> solid(Solid::Kind kind, std::vector<double> sizes) {
  return std::make_shared<Solid>(Solid{.kind = kind, .sizes = std::move(sizes), .children = {}, .placement = {}});
}
inline Solid difference(std::shared_ptr<const Solid> a, std::shared_ptr<const Solid> b) {
  return {.kind = Solid::Kind::difference, .sizes = {}, .children = {std::move(a), std::move(b)}, .placement = {}};
}

inline BodyDescription body_of(const std::string& name, const Solid& solid, double voxel_size) {
  BodyDescription body;
  body.name = name;
  body.parts.push_back(load_solid(solid, {}));
  body.voxel_size = voxel_size;
  return body;
}

/// Pushes the pin in, against the wall, and pulls it out again. A hand remembers: one for every simulation.
inline std::shared_ptr<Device> hand_of_brep_pin() {
  return hand_along({{0.002, 0, 0.2}, {0.006, 0.001, 0}, {0.002, 0, 0.2}}, 0.5, 0.0005);
}

/// The published script's block (0.1 m high, hole of 75 mm) and pin (0.2 m long, 70 mm), both with origins in the
/// middle.
inline Scene brep_pin_in_hole(Hybrid hybrid, double voxel_size = 0.0045) {
  constexpr double kHeight = 0.1, kLength = 0.2;
  Scene scene;
  scene.parameters.duration = 1.2;
  scene.parameters.hybrid = hybrid;
  const Solid bored = difference(solid(Solid::Kind::box, {0.375, 0.375, kHeight}),
                                 solid(Solid::Kind::cylinder, {0.075, 1.5 * kHeight}));
  BodyDescription block = body_of("block", bored, voxel_size);
  block.fixed = true;
  BodyDescription pin = body_of("pin", *solid(Solid::Kind::cylinder, {0.070, kLength}), voxel_size);
  pin.density = 10;
  pin.X_WB.position = {0.002, 0, 0.18};
  scene.bodies = {std::move(block), std::move(pin)};
  scene.devices = {hand_of_brep_pin()};
  scene.grasps = {{0, 1}};
  return scene;
}

}  // namespace verisim::scenes
