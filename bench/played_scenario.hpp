// A scenario played once with a clock around each step. Played again, bit for bit, each frame keeps its least time: a
// neighbour on the machine can only add.
#pragma once

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <utility>
#include <vector>

#include "engine/script/scenario.hpp"

namespace verisim::bench {

/// Calls begin(scene) before, after_step(simulation) behind each step, end(simulation, scenario) at last.
/// @param least_us  of each frame with contact, the least so far; 0: it had none
template <typename Begin, typename AfterStep, typename End>
void play(const ScenarioOptions& options, std::vector<double>& least_us, Begin begin, AfterStep after_step, End end) {
  using Clock = std::chrono::steady_clock;
  Inputs inputs = Inputs::live(std::filesystem::path(options.path).parent_path().string(), {});
  Scenario scenario(options, inputs);
  Scene scene = scenario.take_scene();
  begin(scene);
  Simulation simulation(std::move(scene), {});
  scenario.attach(simulation);
  least_us.resize(simulation.frames_planned());
  while (simulation.frame() < simulation.frames_planned()) {
    simulation.prepare();
    const std::uint64_t touched = simulation.collision_frames();
    double& least = least_us[simulation.frame()];
    const auto start = Clock::now();
    simulation.step();
    const double us = std::chrono::duration<double, std::micro>(Clock::now() - start).count();
    if (simulation.collision_frames() > touched) least = least > 0 ? std::min(least, us) : us;
    simulation.clear_events();
    after_step(simulation);
  }
  end(simulation, scenario);
}

}  // namespace verisim::bench
