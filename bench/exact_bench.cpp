// What the exact response costs a frame (search and solution) in the driven insertion of
// ../shared/reference/peers/README.md, at each clearance; beside it the plain voxmap loop of plain_loop.hpp on the same
// number of frames, the unit in which that page's own figures are given (22.9 us there). And with a taper that lies
// flush in its seat, where every sample of both touches.
//
// The task is run again and again; each frame keeps its best time of all rounds (pose_times.hpp says why), so that
// medians and percentiles are over frames.
#include <benchmark/benchmark.h>

#include <chrono>

#include "bench/peg_scene.hpp"
#include "bench/plain_loop.hpp"
#include "bench/pose_times.hpp"
#include "bench/promise.hpp"
#include "engine/base/quantile.hpp"
#include "tests/exact/driven_insertion.hpp"
#include "tests/exact/seated_cone.hpp"

namespace verisim::bench {
namespace {

using exact::test::HeldBody;
using exact::test::Insertion;
using exact::test::Start;

/// Frames of one task with what contact costs in each.
struct FrameTimes {
  std::vector<double> best;  ///< us
  double rows = 0, samples = 0, slides = 0;
  int iterations_max = 0;

  [[nodiscard]] double percentile(double p) const {
    std::vector<double> times = best;
    return quantile(times, p);
  }
  void report(benchmark::State& state) const {
    state.counters["median_us"] = percentile(0.5);
    state.counters["p99_us"] = percentile(0.99);
    state.counters["rows"] = rows;
    state.counters["samples"] = samples;
    state.counters["slides"] = slides;
    state.counters["iterations_max"] = iterations_max;
  }
};

/// Runs a task of `steps` frames; `each(held)` is called after every one of its first run.
template <typename Body, typename HandAt, typename Each>
void play(Body held, HandAt&& hand_at, int steps, FrameTimes& times, Each&& each) {
  using Clock = std::chrono::steady_clock;
  const bool is_first = times.best.empty();
  times.best.resize(static_cast<std::size_t>(steps), std::numeric_limits<double>::infinity());
  for (int i = 0; i < steps; ++i) {
    Matrix6d M;
    Vector6d u0;
    held.pull(hand_at(i * held.dt), M, u0);
    const auto start = Clock::now();
    held.contact(M, u0);
    double& best = times.best[static_cast<std::size_t>(i)];
    best = std::min(best, std::chrono::duration<double, std::micro>(Clock::now() - start).count());
    held.move();
    if (!is_first) continue;
    times.rows += static_cast<double>(held.link.rows().rows().size()) / steps;
    times.samples += static_cast<double>(held.link.cost().samples) / steps;
    times.slides += static_cast<double>(held.link.cost().closest_places) / steps;
    times.iterations_max = std::max(times.iterations_max, held.iterations);
    each(held);
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
  double overlap_max = 0;
  for (auto _ : state) {
    play(
        exact::test::pin_for(task), [&](double t) { return exact::test::hand_at(task, t); },
        exact::test::steps_of(task), times,
        [&](const exact::test::HeldPin& pin) { overlap_max = std::max(overlap_max, pin.overlap()); });
  }
  times.report(state);
  at_most(state, "median_us", times.percentile(0.5), 20);
  at_most(state, "p99_us", times.percentile(0.99), 100);
  state.counters["plain_voxmap_loop_us"] = plain_loop_us();
  if (task.chamfer > 0) return;  // the closed form of the overlap is that of a sharp hole
  state.counters["overlap_per_clearance"] = overlap_max / task.clearance;
  if (overlap_max > 0.025 * task.clearance) wrong(state, "deeper than 2.5 % of the clearance");
}
BENCHMARK(BM_DrivenInsertion)
    ->ArgsProduct({{1000, 100, 20, 10}, {0, 1}})
    ->Iterations(smoke() ? 1 : 7)
    ->Unit(benchmark::kMillisecond);

/// Argument: how much wider the seat is than the taper [um].
void BM_SeatedCone(benchmark::State& state) {
  FrameTimes times;
  for (auto _ : state)
    play(exact::test::seated_cone(1e-6 * static_cast<double>(state.range(0))), exact::test::hand_over_seat,
         exact::test::kSeatSteps, times, [](const HeldBody&) {});
  times.report(state);
}
BENCHMARK(BM_SeatedCone)->Arg(0)->Arg(10)->Iterations(smoke() ? 1 : 7)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace verisim::bench
