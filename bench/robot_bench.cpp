// What the mobile robot's physics cost a millisecond: driving, starting, stopping and pushed, with the floor under it,
// and its odometry beside.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>

#include "bench/promise.hpp"
#include "engine/robot/boards.hpp"
#include "engine/robot/odometry.hpp"
#include "engine/robot/robot.hpp"

namespace verisim::robot {
namespace {

constexpr int kMilliseconds = 8000;

std::array<std::int16_t, kWheels> duty_at(int millisecond) {
  const int part = millisecond / 500;
  const auto d = static_cast<std::int16_t>(part % 4 == 3 ? 0 : part % 2 == 0 ? 220 : -90);
  const auto e = static_cast<std::int16_t>(part % 3 == 0 ? -d : d);
  return {d, e, e, d};
}

void BM_Plant(benchmark::State& state) {
  double least = 1;
  for (auto _ : state) {
    Plant plant(PlantParameters{});
    Odometry odometry(WheelMap(counts_per_displacement({}, kCountsPerWheelTurn)), {}, {});
    std::size_t edges = 0;
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < kMilliseconds; ++i) {
      const Reaction reaction{{i % 1000 < 300 ? 8.0 : 0.0, 3, -2}, {0, 0, 1}, {0.3, 0, 1}};
      edges += plant.advance(duty_at(i), reaction).size();
      odometry.advance(plant.state().counts);
    }
    least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    const ElectricalBook& e = plant.electrical_book();
    const double given = e.battery + e.bridges + e.windings + plant.mechanics().book().motors + plant.coil_energy();
    if (!(std::abs(e.source - given) < 1e-6 * e.source)) return bench::wrong(state, "the books do not close");
    if (edges < 50000 || plant.unsettled() > 0) return bench::wrong(state, "it did not drive as it should");
    state.counters["edges"] = static_cast<double>(edges);
  }
  bench::at_most(state, "us_per_millisecond", least / kMilliseconds * 1e6, 3);
}
/// The robot as scenes have it: tracker, server, lines, host board with its firmware, plant. Its promise is what it
/// adds to a frame of a millisecond.
void BM_Robot(benchmark::State& state) {
  double least = 1;
  for (auto _ : state) {
    RobotSettings settings;
    settings.pilot.walls.emplace().corners = rectangle(-2, 2, -1.5, 1.5);
    Robot robot(settings, make_board("host"));
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 1; i <= kMilliseconds; ++i) {
      robot.follow(i % 2000 < 1000 ? 0.08 : -0.08, 0.02);
      robot.load({{3, 0, -2}, {0, 1, 0}});
      robot.advance(i * kMillisecond);
    }
    least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    if (std::abs(robot.place().y) < 0.1) return bench::wrong(state, "the robot did not drive");
  }
  bench::at_most(state, "us_per_millisecond", least / kMilliseconds * 1e6, 5);
}
BENCHMARK(BM_Robot)->Iterations(20)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_Plant)->Iterations(20)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace verisim::robot
