// What a frame of 100 boxes of 30 mm costs that fall into a tray under `exact` and heap up there: one step of the
// simulation, all stages. The fall is run again and again; each frame keeps its best time of all rounds, so that
// medians and percentiles are over frames. Figures for the whole fall and for its last third, when all boxes lie in the
// heap.
#include <benchmark/benchmark.h>

#include <chrono>
#include <limits>

#include "bench/promise.hpp"
#include "engine/base/quantile.hpp"
#include "tests/simulation/tray_scene.hpp"

namespace verisim::bench {
namespace {

constexpr double kTray = 0.25;  // m

/// Argument: voxel size, and so the spacing of samples along the boxes' edges [mm].
void BM_BoxesInTray(benchmark::State& state) {
  const int boxes = smoke() ? 10 : 100;
  const std::size_t frames = smoke() ? 100 : 1500;
  const Scene scene = tray::scene_of(boxes, kTray, 1, 1e-3 * static_cast<double>(state.range(0)));
  std::vector<double> best(frames, std::numeric_limits<double>::infinity());
  double iterations = 0, samples = 0, contacts = 0;
  std::uint64_t left_out = 0;
  for (auto _ : state) {
    Simulation simulation(scene, {});
    for (double& us : best) {
      simulation.prepare();
      const auto start = std::chrono::steady_clock::now();
      simulation.step();
      us = std::min(us, std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());
      simulation.clear_events();
      iterations += static_cast<double>(simulation.cost().solver_steps);
      samples += static_cast<double>(simulation.cost().exact_samples);
      contacts += static_cast<double>(simulation.cost().contacts);
      left_out += simulation.cost().rows_left_out + simulation.cost().solver_unfinished;
    }
  }
  const double steps = static_cast<double>(state.iterations()) * static_cast<double>(frames);
  state.counters["iterations"] = iterations / steps;
  state.counters["samples"] = samples / steps;
  state.counters["contacts"] = contacts / steps;
  std::vector<double> heap(best.end() - static_cast<std::ptrdiff_t>(frames / 3), best.end());
  state.counters["heap_median_us"] = quantile(heap, 0.5);
  std::vector<double> all = best;
  state.counters["p99_us"] = quantile(all, 0.99);
  at_most(state, "median_us", quantile(all, 0.5), 5000);
  if (left_out > 0) wrong(state, "rows were left out, or a problem was not solved");
}
BENCHMARK(BM_BoxesInTray)->Arg(10)->Arg(5)->Iterations(smoke() ? 1 : 3)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace verisim::bench
