// Mecanum kinematics against worked numbers, and its drawing against its formulas.
#include "engine/robot/mecanum.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/pinned_math.hpp"

namespace verisim::robot::mecanum_test {
namespace {

constexpr MecanumGeometry kNexus;

// ORACLES section 2: 7000 RPM at the motor is 11.454 rad/s at the wheel; dissertation section 5.3.1: 0.57 m/s.
TEST(Mecanum, SevenThousandTurnsAMinuteAreTheTopSpeed) {
  const double wheel = 7000.0 / 60 * pinned::kFullTurn / 64;
  EXPECT_NEAR(wheel, 11.454, 5e-4);  // as printed
  const PlanarTwist twist = twist_of(kNexus, {wheel, wheel, wheel, wheel});
  EXPECT_NEAR(twist.vx, 0.5727, 5e-5);
  EXPECT_EQ(twist.vy, 0);
  EXPECT_EQ(twist.omega, 0);
}

TEST(Mecanum, MovesForwardLeftAndCounterClockwiseWithTheSignsOfTheDrawing) {
  EXPECT_EQ(wheel_speeds(kNexus, {0.5, 0, 0}), (PerWheel{10, 10, 10, 10}));
  EXPECT_EQ(wheel_speeds(kNexus, {0, 0.5, 0}), (PerWheel{-10, 10, 10, -10}));
  const PerWheel turning = wheel_speeds(kNexus, {0, 0, 1});  // (l + w) / r = 6
  for (std::size_t i = 0; i < kWheels; ++i) EXPECT_NEAR(turning[i], i % 2 == 0 ? -6 : 6, 1e-14);
}

TEST(Mecanum, ForwardKinematicsUndoInverseKinematics) {
  const MecanumGeometry geometry{0.21, 0.13, 0.04};
  const PlanarTwist there{0.3, -0.2, 0.7};
  const PlanarTwist back = twist_of(geometry, wheel_speeds(geometry, there));
  EXPECT_NEAR(back.vx, there.vx, 1e-15);
  EXPECT_NEAR(back.vy, there.vy, 1e-15);
  EXPECT_NEAR(back.omega, there.omega, 1e-15);
}

TEST(Mecanum, ResidualOfSpeedsWithoutSlipIsZeroAndOfOneWheelAloneIsNot) {
  for (const PlanarTwist& twist : {PlanarTwist{0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 1}, {0.3, -0.2, 0.7}})
    EXPECT_NEAR(slip_residual(wheel_speeds(kNexus, twist)), 0, 1e-14);
  EXPECT_EQ(slip_residual({1, 0, 0, 0}), 1);
  EXPECT_EQ(slip_residual({0, 0, 0, 1}), -1);
}

// a . (v + omega x p) = a . (r w, 0): the condition of which the formulas are made, with the places as drawn.
TEST(Mecanum, NoRollerSlipsAlongItsAxle) {
  const PlanarTwist twist{0.3, -0.2, 0.7};
  const PerWheel speeds = wheel_speeds(kNexus, twist);
  for (std::size_t i = 0; i < kWheels; ++i) {
    const auto [p, a] = wheel_place(kNexus, i);
    const double along_x = twist.vx - twist.omega * p[1] - kNexus.wheel_radius * speeds[i];
    const double along_y = twist.vy + twist.omega * p[0];
    EXPECT_NEAR(a[0] * along_x + a[1] * along_y, 0, 1e-15);
    EXPECT_NEAR(std::hypot(a[0], a[1]), 1, 1e-15);
  }
}

}  // namespace
}  // namespace verisim::robot::mecanum_test
