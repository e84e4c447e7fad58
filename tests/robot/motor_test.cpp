// The motor against its data sheet (ORACLES section 2), and the winding against the exponential that it is.
#include "engine/robot/motor.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/pinned_math.hpp"
#include "tests/robot/plants.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::robot::motor_test {
namespace {

using test::tolerance;

constexpr double kRpm = pinned::kFullTurn / 60;
const MotorParameters kMotor;
const BridgeParameters kNoBridge{0, 0};

// 12 V / 1.9 ohm * 13.4 mN m/A. The data sheet's 84.6 is that, before dry friction.
TEST(Motor, StallsAt84Point6MillinewtonMetres) {
  Winding winding(kMotor, kNoBridge, 1e-3);
  (void)winding.begin(12, 0);
  (void)winding.end(0);  // a step of 29 electrical time constants
  const WindingTorque torque = winding.begin(12, 0);
  EXPECT_NEAR(torque.at_rest, 84.6e-3, tolerance(0.05e-3));  // as printed
  EXPECT_NEAR(torque.at_rest, 12 / 1.9 * 13.4e-3, tolerance(1e-15));
}

TEST(Motor, FrictionIsWhatTheNoLoadSpeedLeaves) {
  EXPECT_NEAR(dry_friction(kMotor), 13.4e-3 * (12 - 13.4e-3 * 848.23) / 1.9, tolerance(1e-7));  // 848.23 rad/s
  EXPECT_NEAR(dry_friction(kMotor) / kMotor.torque_constant, 0.334, tolerance(0.5e-3));         // A
}

TEST(Motor, RunsAt8100TurnsAMinuteWithoutLoad) {
  Plant plant(plants::on_a_stand());
  plants::drive(plant, {255, 255, 255, 255}, 200);  // 33 mechanical time constants
  for (const double speed : plant.state().motor_speed) EXPECT_NEAR(speed / kRpm, 8100, tolerance(1e-6));
}

// 101 rpm/mN m: with k_M, R: R / k_M^2. Load: the wheel's rolling resistance, r c N / ratio at the motor.
TEST(Motor, Loses101TurnsAMinutePerMillinewtonMetre) {
  const auto speed = [](double rolling_resistance) {
    PlantParameters p = plants::without_losses();
    p.wheel.rolling_resistance = rolling_resistance;
    Plant plant(p);
    plants::drive(plant, {255, 255, 255, 255}, 3000);
    return plant.state().motor_speed[0];
  };
  const PlantParameters p;
  const double load = 0.02 * p.body.mass * p.gravity / 4 * p.geometry.wheel_radius / p.gear.ratio;
  const double slope = (speed(0) - speed(0.02)) / kRpm / (load * 1e3);
  EXPECT_NEAR(slope, 101, tolerance(0.5));                                      // as printed
  EXPECT_NEAR(slope, 1.9 / (13.4e-3 * 13.4e-3) / kRpm / 1e3, tolerance(1e-3));  // settled to exp(-3 s / 0.18 s)
}

// Two poles; the slow one is 2 T_e / (1 - sqrt(1 - 4 T_e / T_m)) = 6.00 ms with T_m = J R / k_M^2 = 6.03 ms and
// T_e = L / R = 0.034 ms. Steps of 0.125 ms err by their square: (0.125 / 6)^2 / 12 = 4e-5.
TEST(Motor, ReachesItsSpeedWithTheMechanicalTimeConstant) {
  const double T_m = kMotor.inertia * kMotor.resistance / (kMotor.torque_constant * kMotor.torque_constant);
  EXPECT_NEAR(T_m, 6.03e-3, tolerance(0.005e-3));
  const double T_e = kMotor.inductance / kMotor.resistance;
  const double slow = 2 * T_e / (1 - std::sqrt(1 - 4 * T_e / T_m));
  Plant plant(plants::on_a_stand());
  plants::drive(plant, {255, 255, 255, 255}, 3);
  const double early = 8100 * kRpm - plant.state().motor_speed[0];
  plants::drive(plant, {255, 255, 255, 255}, 12);
  const double late = 8100 * kRpm - plant.state().motor_speed[0];
  EXPECT_NEAR(12e-3 / std::log(early / late), slow, tolerance(1e-3 * slow));
}

TEST(Motor, StandsAsLongAsFrictionHoldsIt) {
  Plant plant(plants::on_a_stand());
  // 0.334 A times 1.9 ohm of 12 V is a duty of 13.46.
  plants::drive(plant, {13, 14, -13, -14}, 100);
  EXPECT_EQ(plant.state().motor_speed[0], 0);
  EXPECT_GT(plant.state().motor_speed[1], 0);
  EXPECT_EQ(plant.state().motor_speed[2], 0);
  EXPECT_LT(plant.state().motor_speed[3], 0);
}

// i = U/R (1 - exp(-t/T)), whatever the steps.
TEST(Winding, FollowsTheExponentialInStepsOfAnyLength) {
  const double T = kMotor.inductance / kMotor.resistance, t = 1.5 * T;
  for (const int steps : {1, 2, 7}) {
    Winding winding(kMotor, kNoBridge, t / steps);
    double charge = 0, square = 0;
    for (int i = 0; i < steps; ++i) {
      (void)winding.begin(6, 100);
      const WindingStep step = winding.end(100);
      charge += step.current * t / steps;
      square += step.current_square * t / steps;
    }
    const double settled = (6 - 100 * kMotor.torque_constant) / kMotor.resistance;
    EXPECT_NEAR(winding.current(), settled * (1 - std::exp(-1.5)), tolerance(1e-14));
    EXPECT_NEAR(charge, settled * (t - T * (1 - std::exp(-1.5))), tolerance(1e-18));
    EXPECT_NEAR(square, settled * settled * (t - 2 * T * (1 - std::exp(-1.5)) + T / 2 * (1 - std::exp(-3))),
                tolerance(1e-17));
  }
}

// L298: 1.35 V + 1.2 V at 1 A, 2 V + 1.7 V at 2 A; ORACLES: about 2 V.
TEST(Bridge, DropsWithTheCurrent) {
  for (const auto& [current, drop] : {std::pair{0.5, 1.975}, {1.0, 2.55}, {2.0, 3.7}}) {
    Winding winding(kMotor, {}, 1e-3);
    (void)winding.begin(current * kMotor.resistance + drop, 0);
    (void)winding.end(0);
    EXPECT_NEAR(winding.current(), current, tolerance(1e-12));
  }
}

TEST(Bridge, LetsNoCurrentThroughBelowItsDrop) {
  Winding winding(kMotor, {}, 1e-4);
  EXPECT_EQ(winding.begin(1.39, 0).at_rest, 0);
  EXPECT_EQ(winding.end(0).current, 0);
  EXPECT_GT(winding.begin(1.41, 0).at_rest, 0);
  // A motor that turns brakes through its bridge only above 1.4 V of back-EMF, 104 rad/s.
  Winding turned(kMotor, {}, 1e-4);
  EXPECT_EQ(turned.begin(0, 104).per_speed, 0);
  EXPECT_LT(turned.begin(0, 106).at_rest - turned.begin(0, 106).per_speed * 106, 0);
}

TEST(Winding, ReversesThroughZero) {
  Winding winding(kMotor, {}, 1e-4);
  (void)winding.begin(8, 0);
  (void)winding.end(0);
  ASSERT_GT(winding.current(), 1);
  EXPECT_LT(winding.begin(-8, 0).at_rest, 0);
  EXPECT_GT(winding.lost_at_reversal(), 0);
  (void)winding.end(0);
  EXPECT_LT(winding.current(), -1);
}

}  // namespace
}  // namespace verisim::robot::motor_test
