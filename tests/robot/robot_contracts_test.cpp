// The doors of engine/robot: what each promises to find.
#include <gtest/gtest.h>

#include <limits>

#include "engine/robot/odometry.hpp"
#include "engine/robot/plant.hpp"
#include "tests/support/broken.hpp"

namespace verisim::robot::robot_contracts_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(PlantDeathTest, IsDrivenByDutiesAndReactionsThatMeanSomething) {
  Plant plant(PlantParameters{});
  EXPECT_BROKEN(plant.advance({256, 0, 0, 0}, {}), "std::abs(duty[i]) <= kDutyMax");
  EXPECT_BROKEN(plant.advance({}, {{kNaN, 0, 0}, Vector3d::Zero(), Vector3d::Zero()}), "is_finite(reaction.force)");
  EXPECT_BROKEN(plant.advance({}, {Vector3d::Zero(), {0, kNaN, 0}, Vector3d::Zero()}), "is_finite(reaction.torque)");
  EXPECT_BROKEN(plant.advance({}, {Vector3d::Zero(), Vector3d::Zero(), {0, 0, kNaN}}), "is_finite(reaction.point)");
  EXPECT_BROKEN(plant.set_supply_voltage(-1), "is_not_negative(voltage)");
  EXPECT_BROKEN(plant.set_blocked(4, true), "wheel < kWheels");
  EXPECT_BROKEN(plant.set_encoder_fault(4, EncoderFault::dead), "wheel < kWheels");
  EXPECT_BROKEN(plant.place({kNaN, 0, 0}), "std::isfinite(pose.x + pose.y + pose.theta)");
}

TEST(WindingDeathTest, HasAResistanceAndSteps) {
  MotorParameters motor;
  EXPECT_BROKEN(Winding(motor, {}, 0), "is_positive(step)");
  motor.resistance = 0;
  EXPECT_BROKEN(Winding(motor, {}, 1e-4), "is_positive(motor.resistance)");
}

TEST(MecanumDeathTest, HasWheels) {
  EXPECT_BROKEN(wheel_speeds({0.1, 0.1, 0}, {1, 0, 0}), "is_positive(geometry.wheel_radius)");
  EXPECT_BROKEN(wheel_place({}, 4), "wheel < kWheels");
}

TEST(OdometryDeathTest, NeedsAMapOfFullRankAndTime) {
  EXPECT_BROKEN(WheelMap(CountsPerDisplacement::Zero()), "normal.vectorD().minCoeff() > 0");
  EXPECT_BROKEN(CountRate(0, 1), "is_positive(period)");
  EXPECT_BROKEN(CountRate(1, 0.1), "time >= period");
}

TEST(EncoderDeathTest, TurnsByANumber) {
  Encoder encoder(0);
  Edges edges;
  EXPECT_BROKEN(encoder.turn(kNaN, 0, 1, edges), "std::isfinite(angle)");
}

}  // namespace
}  // namespace verisim::robot::robot_contracts_test
