// The scenes whose bits must not depend on compiler, optimisation, vector width or threads: simulation core only, with
// geometry made from pinned functions.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "engine/simulation/declaring.hpp"
#include "tests/determinism/turned.hpp"
#include "tests/simulation/scenes.hpp"

namespace verisim::determinism {

struct CoreScene {
  std::string name;
  std::function<Scene()> make;
};

/// Gives every surface voxel those of the surfaces that pass within a voxel of its centre: a b-rep without a CAD
/// kernel.
inline void declare(BodyDescription& body, double radius, const std::vector<Plane>& planes) {
  const Declaring declaring(body);
  Face side;
  side.surface = Cylinder{Vector3d::Zero(), Vector3d::UnitZ(), Vector3d::UnitX(), radius, false};
  for (std::uint32_t voxel = 0; voxel < declaring.surface_voxels(); ++voxel) {
    const Vector3d p = declaring.center(voxel);
    std::vector<DeclaredFeatures::Entity> set;
    if (std::abs(p.head<2>().norm() - radius) <= body.voxel_size) set.emplace_back(side);
    for (const Plane& plane : planes) {
      if (std::abs((p - plane.point).dot(plane.normal)) > body.voxel_size) continue;
      Face end;
      end.surface = plane;
      set.emplace_back(end);
    }
    declaring.give(body, p, set);
  }
}

inline Scene hybrid_pin(Hybrid hybrid, Integrator integrator, AlignmentMeasure alignment) {
  const auto end_at = [](double z, double up) { return Plane{{0, 0, z}, up * Vector3d::UnitZ(), Vector3d::UnitX()}; };
  Scene scene = scenes::pin_in_hole();
  scene.parameters.hybrid = hybrid;
  scene.parameters.integrator = integrator;
  scene.parameters.alignment = alignment;
  declare(scene.bodies[0], 0.075, {end_at(0.05, 1), end_at(-0.05, -1)});
  declare(scene.bodies[1], 0.070, {end_at(0.2, 1), end_at(0, -1)});
  return scene;
}

/// Precise contacts: a hand brings `moving` from `start` down to `end` [m] into `standing`, a little
/// beside its axis, and goes back.
inline Scene exact_scene(std::vector<Part> standing, std::vector<Part> moving, double start, double end,
                         double voxel_size) {
  Scene scene;
  scene.parameters.duration = 0.6;
  scene.parameters.hybrid = hybrid::exact;
  for (std::vector<Part>* parts : {&standing, &moving}) {
    BodyDescription& body = scene.bodies.emplace_back();
    body.name = parts == &standing ? "standing" : "moving";
    body.parts = std::move(*parts);
    body.voxel_size = voxel_size;
  }
  scene.bodies[0].fixed = true;
  scene.bodies[1].X_WB.position = {0.0003, 0, start};
  scene.devices = {scenes::hand_along({{0.0003, 0, start}, {0.002, 0.001, end}, {0.0003, 0, start}}, 0.3, 0.0002)};
  scene.grasps = {{0, 1}};
  return scene;
}

inline Scene exact_pin() {
  return exact_scene({turned_tube(0.075, 0.15, -0.05, 0.05)}, {turned_pin(0.0745, 0, 0.2)}, 0.052, -0.01, 0.0045);
}

inline Scene exact_cone() {
  const Turned seat({{0.015, -0.03}, {0.06, -0.03}, {0.06, 0.03}, {0.035, 0.03}}, 0);
  const Turned taper({{0, -0.03}, {0.015, -0.03}, {0.035, 0.03}, {0, 0.03}}, 0);
  return exact_scene({Turned(seat).part("seat")}, {Turned(taper).part("taper")}, 0.01, -0.005, 0.002);
}

/// Two tubes stand side by side, two pins move as one.
inline Scene exact_two_pins() {
  std::vector<Part> tubes;
  std::vector<Part> pins;
  for (const double x : {-0.06, 0.06}) {
    tubes.push_back(turned_tube(0.025, 0.045, -0.03, 0.03, x));
    pins.push_back(turned_pin(0.0246, 0, 0.09, x));
  }
  return exact_scene(std::move(tubes), std::move(pins), 0.032, 0, 0.003);
}

inline std::vector<CoreScene> core_scenes() {
  const auto pin = [](Integrator integrator) {
    Scene scene = scenes::pin_in_hole();
    scene.parameters.integrator = integrator;
    return scene;
  };
  return {{"pin_in_hole", [=] { return pin(Integrator::semi_implicit); }},
          {"pin_in_hole_implicit", [=] { return pin(Integrator::implicit); }},
          {"pin_restored",
           [] { return hybrid_pin(hybrid::restore, Integrator::semi_implicit, AlignmentMeasure::by_type); }},
          {"pin_restored_implicit",
           [] { return hybrid_pin(hybrid::restore, Integrator::implicit, AlignmentMeasure::pavlik); }},
          {"pin_blended", [] { return hybrid_pin(hybrid::blend, Integrator::semi_implicit, AlignmentMeasure::faas); }},
          {"pin_exact", exact_pin},
          {"cone_exact", exact_cone},
          {"two_pins_exact", exact_two_pins},
          {"falling_boxes", [] { return scenes::falling_boxes(3, Integrator::semi_implicit); }},
          {"falling_boxes_implicit", [] { return scenes::falling_boxes(3, Integrator::implicit); }}};
}

/// What a run of a scene came to: every bit of its state is in the hash; the counts show that it reached the code.
struct CoreResult {
  std::uint64_t hash = 0, contacts = 0, points_tested = 0, collision_frames = 0, constrained_frames = 0;
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
  const Totals& totals = simulation.totals();
  for (std::size_t kind = 1; kind < totals.constraint_frames.size(); ++kind)
    result.constrained_frames += totals.constraint_frames[kind];
  return result;
}

}  // namespace verisim::determinism
