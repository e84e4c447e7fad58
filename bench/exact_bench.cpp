// What the exact response costs a frame (search and solution) in the driven insertion of
// ../shared/reference/peers/README.md, at each clearance; beside it the plain voxmap loop of plain_loop.hpp on the same
// number of frames, the unit in which that page's own figures are given (22.9 us there).
//
// The insertion is run again and again; each frame keeps its best time of all rounds (pose_times.hpp says why), so that
// medians and percentiles are over frames.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cstdlib>

#include "bench/peg_scene.hpp"
#include "bench/plain_loop.hpp"
#include "bench/pose_times.hpp"
#include "tests/exact/driven_insertion.hpp"

namespace verisim::bench {
namespace {

using exact::test::Insertion;
using exact::test::Start;

/// Frames of one insertion with what contact costs in each.
struct FrameTimes {
  std::vector<double> best;  ///< us
  double rows = 0, samples = 0;
  int iterations_max = 0;
  double overlap_max = 0;  ///< m

  [[nodiscard]] double percentile(double share) const {
    std::vector<double> sorted = best;
    std::sort(sorted.begin(), sorted.end());
    return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size()))];
  }
};

void play(const Insertion& task, bool is_first, FrameTimes& times) {
  using Clock = std::chrono::steady_clock;
  exact::test::HeldPin pin = exact::test::pin_for(task);
  const int steps = exact::test::steps_of(task);
  times.best.resize(static_cast<std::size_t>(steps), std::numeric_limits<double>::infinity());
  for (int i = 0; i < steps; ++i) {
    Matrix6d M;
    Vector6d u0;
    pin.pull(exact::test::hand_at(task, i * pin.dt), M, u0);
    const auto start = Clock::now();
    pin.contact(M, u0);
    double& best = times.best[static_cast<std::size_t>(i)];
    best = std::min(best, std::chrono::duration<double, std::micro>(Clock::now() - start).count());
    pin.move();
    if (!is_first) continue;
    times.rows += static_cast<double>(pin.link.rows().rows().size()) / steps;
    times.samples += static_cast<double>(pin.link.cost().samples) / steps;
    times.iterations_max = std::max(times.iterations_max, pin.iterations);
    times.overlap_max = std::max(times.overlap_max, pin.overlap());
  }
}

double plain_loop_us() {
  const PegScene scene = make_peg_scene(0.0045);
  const PlainLoop loop(scene.block.voxmap, scene.pin.shell);
  const std::vector<Pose> poses = load_peg_poses().X_AB;
  if (poses.empty()) return 0;
  PoseTimes times(poses);
  Wrench sum;
  for (int round = 0; round < 5; ++round) times.round([&](const Pose& X_AB) { sum += loop.force(X_AB, 1000); });
  benchmark::DoNotOptimize(sum);
  return times.percentile(0.5);
}

/// Arguments: clearance [um]; 1: from above, into a chamfer of 2 mm, else from 10 mm deep.
void BM_DrivenInsertion(benchmark::State& state) {
  Insertion task{.clearance = 1e-6 * static_cast<double>(state.range(0))};
  if (state.range(1) == 1) {
    task.start = Start::above;
    task.chamfer = 0.002;
  }
  FrameTimes times;
  bool is_first = true;
  for (auto _ : state) {
    play(task, is_first, times);
    is_first = false;
  }
  state.counters["median_us"] = times.percentile(0.5);
  state.counters["p99_us"] = times.percentile(0.99);
  state.counters["plain_voxmap_loop_us"] = plain_loop_us();
  state.counters["rows"] = times.rows;
  state.counters["samples"] = times.samples;
  state.counters["iterations_max"] = times.iterations_max;
  if (task.chamfer > 0) return;  // the closed form of the overlap is that of a sharp hole
  state.counters["overlap_share"] = times.overlap_max / task.clearance;
  if (times.overlap_max > 0.025 * task.clearance) state.SkipWithError("deeper than 2.5 % of the clearance");
}
BENCHMARK(BM_DrivenInsertion)
    ->ArgsProduct({{1000, 100, 20, 10}, {0, 1}})
    ->Iterations(std::getenv("VERISIM_BENCH_SMOKE") != nullptr ? 1 : 7)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace verisim::bench

BENCHMARK_MAIN();
