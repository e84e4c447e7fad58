// What a frame of a conforming contact costs under `exact`: the scenes of tests/outside in which a body rests in a seat
// that fits it, or a hand presses it into one. One step of the simulation, all stages. The run is repeated, bit for
// bit, and each frame keeps its least time, so that medians and percentiles are over frames.
#include <benchmark/benchmark.h>

#include <array>
#include <limits>

#include "bench/played_scenario.hpp"
#include "bench/promise.hpp"
#include "engine/base/quantile.hpp"
#include "tests/support/paths.hpp"

namespace verisim::bench {
namespace {

struct Case {
  const char *name, *file;
  std::vector<std::pair<std::string, std::string>> sets;
};
std::vector<Case> cases() {
  std::vector<Case> all;
  for (const char* kind : {"tube", "socket", "bore", "ring", "cone", "bowl", "plug"})
    all.push_back({kind, "conforming.lua", {{"kind", kind}, {"drop", "0.0000005"}, {"side", "0.0000001"}}});
  for (const char* wall : {"flat", "cone", "tube", "socket"})
    all.push_back({wall, "press.lua", {{"wall", wall}, {"hybrid", "exact"}, {"integrator", "implicit"}}});
  return all;
}

/// Times of the frames with contact, the least of all rounds [us]; 0: no contact.
void play_case(const Case& one, std::vector<double>& least, FrameCost& cost) {
  ScenarioOptions options;
  options.path = paths::in_sources("tests/outside/") + one.file;
  options.sets = one.sets;
  if (smoke()) options.duration = 0.2;
  play(
      options, least, [](const Scene&) {}, [](const Simulation&) {},
      [&](const Simulation& simulation, const Scenario&) { cost = simulation.cost(); });
}

/// Argument: which case.
void BM_Conforming(benchmark::State& state) {
  const Case one = cases().at(static_cast<std::size_t>(state.range(0)));
  state.SetLabel(std::string(one.file) + " " + one.name);
  std::vector<double> least;
  FrameCost cost;
  for (auto _ : state) play_case(one, least, cost);
  std::erase(least, 0);
  if (least.empty() && !smoke()) return wrong(state, "nothing touched");
  if (least.empty()) return;
  state.counters["samples"] = static_cast<double>(cost.exact_samples);
  state.counters["rows"] = static_cast<double>(cost.contacts);
  state.counters["iterations"] = static_cast<double>(cost.solver_steps);
  state.counters["p99_us"] = quantile(least, 0.99);
  at_most(state, "median_us", quantile(least, 0.5), 60);
}
BENCHMARK(BM_Conforming)->DenseRange(0, 10)->Iterations(smoke() ? 1 : 3)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace verisim::bench
