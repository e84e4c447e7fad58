// The whole robot on the floor: where it drives, how fast, and that the substep, the repetition and the heap do not
// show.
#include "engine/robot/plant.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstring>

#include "engine/base/pinned_math.hpp"
#include "tests/contact/allocations.hpp"
#include "tests/robot/plants.hpp"

namespace verisim::robot::plant_test {
namespace {

using plants::drive;
using plants::Duties;

constexpr double kRpm = pinned::kFullTurn / 60;
constexpr double kCount = pinned::kFullTurn / 3072;  // of a wheel [rad]

/// The speed of a motor under a torque, at a duty: k (d V - V_0 - k w) / (R + R_0) = load, V = V_supply - 4 d R_b i.
double settled_speed(const PlantParameters& p, double duty, double load) {
  const double k = p.motor.torque_constant, current = load / k;
  const double supply = p.supply.voltage - 4 * duty * p.supply.resistance * current;
  return (duty * supply - p.bridge.drop - (p.motor.resistance + p.bridge.drop_per_ampere) * current) / k;
}

/// Torque at the motor against which it drives when each wheel's floor takes `torque` from it [N m].
double load_of(const PlantParameters& p, double torque) {
  const double N = p.body.mass * p.gravity / 4;
  return dry_friction(p.motor) +
         (p.wheel.rolling_resistance * N * p.geometry.wheel_radius + torque) / (p.gear.ratio * p.gear.efficiency);
}

struct Motion {
  const char* name;
  Duties duty;
  double lever;  ///< torque of a wheel that turns its rollers: c N times this [m]
};

// A roller's rim runs at sqrt 2 of the wheel's in a strafe, and at 1 / sqrt 2 in a turn with l = w; its resistance
// takes that much power, and the wheel gives it.
const Motion kMotions[] = {{"straight", {200, 200, 200, 200}, 0},
                           {"strafe", {-200, 200, 200, -200}, std::sqrt(2.0) * 0.05},
                           {"turn", {-200, 200, -200, 200}, 0.05 / std::sqrt(2.0)}};

TEST(Plant, DrivesStraightSidewaysAndAroundAsKinematicsSay) {
  const PlantParameters p;
  for (const Motion& motion : kMotions) {
    SCOPED_TRACE(motion.name);
    Plant plant(p);
    drive(plant, motion.duty, 2000);
    const double load = load_of(p, motion.lever * p.wheel.roller_resistance * p.body.mass * p.gravity / 4);
    const double speed = settled_speed(p, 200.0 / 255, load);
    PerWheel wheels;
    for (std::size_t i = 0; i < kWheels; ++i) wheels[i] = std::copysign(speed / p.gear.ratio, motion.duty[i]);
    const PlanarTwist expected = twist_of(p.geometry, wheels), got = plant.state().twist;
    // Settled to exp(-2 s / 0.25 s) = 3e-4; without slip.
    EXPECT_NEAR(got.vx, expected.vx, 0.005 * std::abs(expected.vx) + 1e-9);
    EXPECT_NEAR(got.vy, expected.vy, 0.005 * std::abs(expected.vy) + 1e-9);
    EXPECT_NEAR(got.omega, expected.omega, 0.005 * std::abs(expected.omega) + 1e-9);
    for (const double slip : plant.state().slip) EXPECT_NEAR(slip, 0, 1e-6);
    EXPECT_EQ(plant.unsettled(), 0u);
  }
}

// One count is 0.1023 mm of floor. What counts do not see: half the backlash (0.44 mm), rubber (0.1 mm).
TEST(Plant, GoesAsFarAsItsEncodersCount) {
  for (const Motion& motion : kMotions) {
    SCOPED_TRACE(motion.name);
    const PlantParameters p;
    Plant plant(p);
    plants::start(plant, motion.duty, 2500);
    PerWheel angle;
    for (std::size_t i = 0; i < kWheels; ++i) angle[i] = static_cast<double>(plant.state().counts[i]) * kCount;
    const PlanarTwist way = twist_of(p.geometry, angle);
    const PlanarPose pose = plant.state().pose;
    const double turned = p.geometry.half_base + p.geometry.half_track;
    const double length = std::abs(pose.x) + std::abs(pose.y) + turned * std::abs(pose.theta);
    EXPECT_GT(length, 0.5);
    EXPECT_NEAR(pose.x, way.vx, 0.005 * length);
    EXPECT_NEAR(pose.y, way.vy, 0.005 * length);
    EXPECT_NEAR(pose.theta, way.omega, 0.005 * length / turned);
    EXPECT_NEAR(std::abs(pose.x) + std::abs(pose.y) + turned * std::abs(pose.theta),
                std::abs(way.vx) + std::abs(way.vy) + turned * std::abs(way.omega), 0.7e-3);
  }
}

// Dissertation section 5.3.1 and ORACLES: 7000 RPM are 0.5727 m/s. The supply that gives them follows from the motor.
TEST(Plant, IsAsFastAsPublishedAt7000TurnsAMinute) {
  PlantParameters p;
  const double load = load_of(p, 0);
  p.supply.voltage += (7000 * kRpm - settled_speed(p, 1, load)) * p.motor.torque_constant;
  Plant plant(p);
  drive(plant, {255, 255, 255, 255}, 4000);
  EXPECT_NEAR(plant.state().motor_speed[0] / kRpm, 7000, 7);
  EXPECT_NEAR(plant.state().twist.vx, 0.5727, 0.001 * 0.5727);
  std::printf("7000 RPM take a supply of %.2f V\n", p.supply.voltage);
}

TEST(Plant, SaysWhatItReachesAt12VoltsLessTheBridgesDrop) {
  for (const auto& [name, duty] : {std::pair{"straight", Duties{255, 255, 255, 255}},
                                   {"strafe", Duties{-255, 255, 255, -255}},
                                   {"turn", Duties{-255, 255, -255, 255}}}) {
    Plant plant(PlantParameters{});
    drive(plant, duty, 4000);
    const PlantState& s = plant.state();
    std::printf("12 V, %-8s: %.0f RPM, %.3f m/s, %.3f rad/s, %.2f V at the bridges, %.2f A a motor\n", name,
                std::abs(s.motor_speed[0]) / kRpm, std::hypot(s.twist.vx, s.twist.vy), s.twist.omega, s.supply_voltage,
                std::abs(s.current[0]));
    EXPECT_LT(std::abs(s.motor_speed[0]), 7000 * kRpm);
    EXPECT_NEAR(s.supply_voltage, 12 - 0.15 * 4 * std::abs(s.current[0]), 0.01);
  }
}

/// Starts, stops, curves and a turn on the spot, 4 s.
Duties errand(int millisecond) {
  const int part = millisecond / 500;
  const Duties parts[] = {{180, 180, 180, 180}, {255, 100, 200, 150},   {0, 0, 0, 0},        {-90, 90, 120, -150},
                          {60, 60, 60, 60},     {-200, 200, -200, 200}, {-255, 255, 0, 100}, {0, 0, 0, 0}};
  return parts[part % 8];
}

// Half a step moves a start or a stop by less than one encoder count (0.1 mm; 0.3 mrad of a turn by 0.3 m).
TEST(Plant, ShowsNothingOfItsSubstep) {
  PlantParameters fine;
  fine.substeps *= 2;
  Plant coarse(PlantParameters{}), finer(fine);
  double away = 0, turned = 0, faster = 0;
  for (int i = 0; i < 4000; ++i) {
    coarse.advance(errand(i), {});
    finer.advance(errand(i), {});
    const PlantState &a = coarse.state(), &b = finer.state();
    away = std::max(away, std::hypot(a.pose.x - b.pose.x, a.pose.y - b.pose.y));
    turned = std::max(turned, std::abs(a.pose.theta - b.pose.theta));
    faster = std::max(faster, std::hypot(a.twist.vx - b.twist.vx, a.twist.vy - b.twist.vy));
    for (std::size_t w = 0; w < kWheels; ++w) ASSERT_LE(std::abs(a.counts[w] - b.counts[w]), 1) << i;
  }
  std::printf("half the substep: %.3f mm, %.3f mrad, %.2f mm/s at most\n", away * 1e3, turned * 1e3, faster * 1e3);
  EXPECT_LT(away, 0.1023e-3);
  EXPECT_LT(turned, 0.1023e-3 / 0.3);
  EXPECT_EQ(coarse.unsettled(), 0u);
}

TEST(Plant, GivesTheSameBitsTwice) {
  Plant first(PlantParameters{}), second(PlantParameters{});
  const Reaction reaction{{3, -20, 5}, {1, 2, 3}, {0.4, 0.1, 1.0}};
  std::size_t edges = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto a = first.advance(errand(i), reaction), b = second.advance(errand(i), reaction);
    ASSERT_EQ(a.size(), b.size());
    edges += a.size();
    for (std::size_t k = 0; k < a.size(); ++k) {
      ASSERT_EQ(a[k].cycle, b[k].cycle);
      ASSERT_EQ(a[k].levels, b[k].levels);
    }
    ASSERT_EQ(std::memcmp(&first.state(), &second.state(), sizeof(PlantState)), 0) << i;
  }
  EXPECT_GT(edges, 10000u);
}

TEST(Plant, AllocatesNothing) {
  Plant plant(PlantParameters{});
  const std::uint64_t before = allocations;
  for (int i = 0; i < 1000; ++i) plant.advance(errand(i), {});
  EXPECT_EQ(allocations, before);
}

// 22,400 edges a second, 5.6 a wheel and millisecond (dissertation section 5.3.2), in order, and as many as counts.
TEST(Plant, GivesTheEdgesOfItsCounts) {
  PlantParameters p;
  p.supply.voltage = 12.6;
  Plant plant(p);
  drive(plant, {255, 255, 255, 255}, 3000);
  const auto before = plant.state().counts;
  std::size_t edges = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto now = plant.advance({255, 255, 255, 255}, {});
    edges += now.size();
    for (std::size_t k = 1; k < now.size(); ++k) ASSERT_LE(now[k - 1].cycle, now[k].cycle);
    for (const Edge& edge : now) ASSERT_LT(edge.cycle, kCyclesPerMillisecond);
  }
  std::int64_t counted = 0;
  for (std::size_t w = 0; w < kWheels; ++w) counted += plant.state().counts[w] - before[w];
  EXPECT_EQ(static_cast<std::int64_t>(edges), counted);
  EXPECT_NEAR(static_cast<double>(edges), 22400, 500);
  EXPECT_EQ(plant.edges_dropped(), 0u);
}

}  // namespace
}  // namespace verisim::robot::plant_test
