// What the hybrid method costs a frame: the same contacts with `off`, `restore` and `blend`.
//
// The poses of a pin in a hole are put before one simulation of each method, in turns: every frame begins where it is
// told to, at rest, so that all see the same contacts. Each frame keeps its best time of all rounds (pose_times.hpp
// says why).
#include <benchmark/benchmark.h>

#include "bench/pose_times.hpp"
#include "bench/promise.hpp"
#include "engine/base/random.hpp"
#include "engine/simulation/simulation.hpp"
#include "tests/simulation/hybrid_scenes.hpp"

namespace verisim::bench {
namespace {

constexpr std::size_t kPin = 1;

std::vector<Pose> poses_in_contact(const Scene& scene, std::size_t stride) {
  Simulation simulation(scene, {});
  std::vector<Pose> poses;
  while (simulation.frame() < simulation.frames_planned()) {
    const Pose before = simulation.body_pose(kPin);  // what this frame's contacts are found in
    simulation.step();
    if (simulation.cost().contacts > 0 && simulation.frame() % stride == 0) poses.push_back(before);
  }
  return poses;
}

/// Pressed against the wall and its rim, up to a quarter of a voxel deep, a little tilted: many more contacts.
std::vector<Pose> poses_pressed(double voxel_size, int count) {
  const RandomStream r(1, "pressed poses");
  std::vector<Pose> poses;
  for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(count); ++i) {
    const Vector3d side = rotation_from_vector({0, 0, 6.28 * r.uniform(4 * i)}) * Vector3d::UnitX();
    const double beside = 0.005 + 0.25 * voxel_size * r.uniform(4 * i + 1);
    const double height = 0.14 * r.uniform(4 * i + 2);
    const double tilt = 0.002 * (2 * r.uniform(4 * i + 3) - 1);
    poses.push_back(
        {beside * side + Vector3d(0, 0, height), rotation_from_vector(tilt * Vector3d::UnitZ().cross(side))});
  }
  return poses;
}

struct Method {
  const char* name;
  std::unique_ptr<Simulation> simulation;
  PoseTimes times;
  std::uint64_t contacts = 0;
};

void compare(benchmark::State& state, Scene scene, const std::vector<Pose>& poses) {
  std::vector<Method> methods;
  for (const auto& [name, hybrid] :
       {std::pair{"off", hybrid::off}, {"restore", hybrid::restore}, {"blend", hybrid::blend}}) {
    scene.parameters.hybrid = hybrid;
    scene.devices = {scenes::hand_of_brep_pin()};
    methods.push_back({name, std::make_unique<Simulation>(scene, SimulationOptions{}), PoseTimes(poses)});
  }
  for (auto _ : state) {
    for (Method& m : methods) {
      m.contacts = 0;
      m.times.round([&](const Pose& X_WB) { m.simulation->set_body_pose(kPin, X_WB); },
                    [&](const Pose&) {
                      m.simulation->step();
                      m.contacts += m.simulation->cost().contacts;
                    });
      m.simulation->clear_events();
    }
  }
  const Method& off = methods.front();
  for (const Method& m : methods) {
    if (m.contacts != off.contacts || m.contacts == 0) wrong(state, "the methods must see the same contacts");
    state.counters[std::string(m.name) + "_us"] = m.times.mean();
    state.counters[std::string(m.name) + "_ratio"] = m.times.mean() / off.times.mean();
  }
  at_most(state, "restore_ratio", methods[1].times.mean() / off.times.mean(), 1.3);
  state.counters["contacts"] = static_cast<double>(off.contacts) / static_cast<double>(poses.size());
}

/// The frames of a run in which the pin is driven into the hole and out again, with the method off.
void BM_DrivenPin(benchmark::State& state) {
  const Scene scene = scenes::brep_pin_in_hole(hybrid::off);
  compare(state, scene, poses_in_contact(scene, smoke() ? 20 : 1));
}
BENCHMARK(BM_DrivenPin)->Iterations(200)->Unit(benchmark::kMillisecond);

/// Arguments: voxel size [um]; 1: the implicit integrator, which wants matrices too.
void BM_PressedPin(benchmark::State& state) {
  const double voxel_size = 1e-6 * static_cast<double>(state.range(0));
  Scene scene = scenes::brep_pin_in_hole(hybrid::off, voxel_size);
  if (state.range(1) == 1) scene.parameters.integrator = Integrator::implicit;
  compare(state, scene, poses_pressed(voxel_size, smoke() ? 20 : 300));
}
BENCHMARK(BM_PressedPin)->ArgsProduct({{4500, 2000}, {0, 1}})->Iterations(200)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace verisim::bench
