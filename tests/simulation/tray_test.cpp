// Many boxes fall into a tray under `exact`: 40 of them in 0.6 s; 100 in 4 s with VERISIM_LONG_TESTS=1. How deep they
// overlap is measured by geometry from poses alone, and told as a distribution.
#include <gtest/gtest.h>

#include <cstdio>

#include "engine/base/quantile.hpp"
#include "tests/length.hpp"
#include "tests/simulation/tray_scene.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::tray_test {
namespace {

struct Fall {
  std::vector<double> between, with_tray;  ///< m, overlaps of every pair in every fourth frame
  double energy_gain = 0;                  ///< largest, of the energy of the fall
  double kinetic_end = 0, height_end = 0;  ///< J per box; m, of the highest
  std::uint64_t rows_left_out = 0, unfinished = 0, largest_step = 0, hash = 0;
};

Fall fall_of(int boxes, double tray, std::uint64_t seed, int frames, double voxel_size) {
  Simulation simulation(tray::scene_of(boxes, tray, seed, voxel_size), {});
  const auto energy = [&] { return simulation.energy().kinetic + simulation.energy().gravity; };
  const double before = energy();
  double fall = 0;
  for (std::size_t i = 1; i < simulation.body_count(); ++i)
    fall += simulation.mass(i) * 9.81 * (simulation.body_pose(i).position.z() - tray::kSide / 2);
  Fall result;
  for (int frame = 0; frame < frames; ++frame) {
    simulation.prepare();
    simulation.step();
    simulation.clear_events();
    result.energy_gain = std::max(result.energy_gain, (energy() - before) / fall);
    result.rows_left_out += simulation.cost().rows_left_out;
    result.unfinished += simulation.cost().solver_unfinished;
    result.largest_step = std::max(result.largest_step, simulation.cost().solver_steps);
    if (frame % 4 == 0) tray::add_overlaps(simulation, tray, result.between, result.with_tray);
  }
  for (std::size_t i = 1; i < simulation.body_count(); ++i)
    result.height_end = std::max(result.height_end, simulation.body_pose(i).position.z());
  result.kinetic_end = simulation.energy().kinetic / boxes;
  result.hash = simulation.state_hash();
  return result;
}

void print(const char* what, std::vector<double> overlaps) {
  if (overlaps.empty()) return;
  const double most = *std::max_element(overlaps.begin(), overlaps.end());
  std::printf("overlap %s, um: %zu seen, median %.3g, 99 %% %.3g, 99.9 %% %.3g, max %.4g\n", what, overlaps.size(),
              1e6 * quantile(overlaps, 0.5), 1e6 * quantile(overlaps, 0.99), 1e6 * quantile(overlaps, 0.999),
              1e6 * most);
}

TEST(Tray, HoldsManyBoxes) {
  const int boxes = test::by_length(10, 40, 100);
  const int frames = test::by_length(400, 600, 4000);
  const double tray = test::is_long() ? 0.25 : 0.16;
  const Fall fall = fall_of(boxes, tray, 1, frames, 0.01);
  print("between boxes", fall.between);
  print("with the tray", fall.with_tray);
  std::printf("energy gain %.3g, kinetic energy left %.3g J per box, highest %.1f mm, most iterations %d\n",
              fall.energy_gain, fall.kinetic_end, 1e3 * fall.height_end, static_cast<int>(fall.largest_step));
  EXPECT_EQ(fall.rows_left_out, 0U);
  EXPECT_EQ(fall.unfinished, 0U);
  EXPECT_LE(fall.energy_gain, 0.001);
  EXPECT_GT(fall.between.size(), test::by_length<std::size_t>(10, 100, 100))
      << "the boxes never met: this proves nothing";
  std::vector<double> between = fall.between;
  EXPECT_LE(quantile(between, 0.5), 5e-6);
  EXPECT_LE(quantile(between, 0.99), 3e-5);
  EXPECT_LE(quantile(between, 1), 3e-4);  // boxes that spin meet at 1.5 m/s
  std::vector<double> with_tray = fall.with_tray;
  EXPECT_LE(quantile(with_tray, 0.99), 5e-5);
}

TEST(Tray, HoldsThemTheSameToTheBitEveryTime) {
  const int frames = test::by_length(100, 300, 600);
  EXPECT_EQ(fall_of(15, 0.12, 2, frames, 0.01).hash, fall_of(15, 0.12, 2, frames, 0.01).hash);
}

}  // namespace
}  // namespace verisim::tray_test
