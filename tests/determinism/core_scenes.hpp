// The scenes whose bits must not depend on compiler, optimisation, vector width or threads: simulation core only, with
// geometry made from pinned functions.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/simulation/scenes.hpp"

namespace verisim::determinism {

struct CoreScene {
  std::string name;
  std::function<Scene()> make;
};

inline std::vector<CoreScene> core_scenes() {
  const auto pin = [](Integrator integrator) {
    Scene scene = scenes::pin_in_hole();
    scene.parameters.integrator = integrator;
    return scene;
  };
  return {{"pin_in_hole", [=] { return pin(Integrator::semi_implicit); }},
          {"pin_in_hole_implicit", [=] { return pin(Integrator::implicit); }},
          {"falling_boxes", [] { return scenes::falling_boxes(3, Integrator::semi_implicit); }},
          {"falling_boxes_implicit", [] { return scenes::falling_boxes(3, Integrator::implicit); }}};
}

/// What a run of a scene came to: every bit of its state is in the hash; the counts show that it reached the code.
struct CoreResult {
  std::uint64_t hash = 0, contacts = 0, points_tested = 0, collision_frames = 0;
  bool operator==(const CoreResult&) const = default;
};

inline CoreResult run_core(const CoreScene& scene, unsigned threads) {
  Simulation simulation(scene.make(), {threads});
  CoreResult result;
  while (simulation.frame() < simulation.frames_planned()) {
    simulation.step();
    simulation.clear_events();
    result.contacts += simulation.cost().contacts;
    result.points_tested += simulation.cost().points_tested;
  }
  result.hash = simulation.state_hash();
  result.collision_frames = simulation.collision_frames();
  return result;
}

}  // namespace verisim::determinism
