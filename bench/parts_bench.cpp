// What a frame costs in which three of many parts move: as much as the three alone. All stages of the simulation, the
// copy of the row for the recorder among them. The scenes are played side by side, again and again; each frame keeps
// its best time of all rounds. Their counted work is the same, or the times say nothing.
#include <benchmark/benchmark.h>

#include <chrono>
#include <limits>
#include <memory>

#include "bench/promise.hpp"
#include "engine/base/quantile.hpp"
#include "tests/simulation/few_move_scene.hpp"

namespace verisim::bench {
namespace {

/// One of the scenes, and the best time of each of its frames [us].
struct Played {
  int others;
  bool fixed;
  std::vector<double> best;
  std::unique_ptr<Simulation> simulation = nullptr;
  std::vector<std::byte> row = {};

  void begin() {
    simulation = std::make_unique<Simulation>(scenes::three_move_among(others, fixed), SimulationOptions{});
    Schema schema;
    simulation->describe(schema);
    row.resize(schema.row_bytes());
  }
  void step(double& us) {
    simulation->prepare();
    const auto start = std::chrono::steady_clock::now();
    simulation->step();
    simulation->write_row(row.data());
    us = std::min(us, std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());
    simulation->clear_events();
  }
  [[nodiscard]] double median() const {
    std::vector<double> all = best;
    return quantile(all, 0.5);
  }
};

bool same_work(const FrameCost& a, const FrameCost& b) {
  for (const CostCounter& counter : kCostCounters)
    if (a.*counter.count != b.*counter.count) return false;
  return true;
}

/// Argument: whether the others are fixed, or could be taken by a hand.
void BM_ThreePartsOf200Move(benchmark::State& state) {
  const std::size_t frames = smoke() ? 250 : 400;  // the hands come down onto the plate within the first 200
  const std::vector<double> never(frames, std::numeric_limits<double>::infinity());
  Played alone{0, true, never};
  Played among{197, state.range(0) == 1, never};
  std::uint64_t contacts = 0;
  bool same = true;
  for (auto _ : state) {
    alone.begin();
    among.begin();
    for (std::size_t i = 0; i < frames; ++i) {
      alone.step(alone.best[i]);
      among.step(among.best[i]);
      same = same && same_work(alone.simulation->cost(), among.simulation->cost());
      contacts += alone.simulation->cost().contacts;
    }
  }
  state.counters["alone_us"] = alone.median();
  state.counters["among_200_us"] = among.median();
  at_most(state, "ratio", among.median() / alone.median(), 1.10);
  if (!same) wrong(state, "the three parts do not cost the same in both scenes");
  if (contacts == 0) wrong(state, "nothing touches: the hands have not come down yet");
}
BENCHMARK(BM_ThreePartsOf200Move)->Arg(1)->Arg(0)->Iterations(smoke() ? 1 : 20)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace verisim::bench
