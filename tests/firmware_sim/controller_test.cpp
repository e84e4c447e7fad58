// The wheel's controller against the published library's numbers.
#include <gtest/gtest.h>

#include "firmware_sim/firmware/pid.hpp"

namespace verisim::firmware {
namespace controller_test {

constexpr std::int32_t kOfGain = 65536, kOfRpm = 16;

// Kp 2, Ki 5, Kd 1 at 100 ms, limits 0 to 255: recorded from the published library (a fork of Arduino PID 1.0.1). All
// of it is exact here too: gains, errors and outputs are multiples of the units.
TEST(Controller, GivesThePublishedNumbers) {
  Pid pid({2 * kOfGain, kOfGain / 2, 10 * kOfGain}, Pid::Windup::clamp);
  constexpr double kInputs[] = {0, 10, 30, 60, 90, 110, 105, 100};
  constexpr double kOutputs[] = {250, 175, 70, 0, 0, 0, 187.5, 197.5};
  for (std::size_t i = 0; i < std::size(kInputs); ++i) {
    const auto velocity = static_cast<std::int32_t>(kInputs[i] * kOfRpm);
    EXPECT_EQ(pid.update(100 * kOfRpm, velocity, 0, 255 * Pid::kOne), kOutputs[i] * Pid::kOne) << i;
  }
}

TEST(Controller, OutputStaysWithinItsLimits) {
  Pid pid({1966, 393, 0}, Pid::Windup::clamp_and_hold);
  for (const std::int32_t setpoint : {112'000, -112'000, 0}) {
    for (int sample = 0; sample < 300; ++sample) {
      const std::int32_t out = pid.update(setpoint, -setpoint, -255 * Pid::kOne, 255 * Pid::kOne);
      ASSERT_LE(out, 255 * Pid::kOne);
      ASSERT_GE(out, -255 * Pid::kOne);
    }
  }
}

// After seconds at the limit the first error of the other sign takes the output off it.
TEST(Controller, HoldsItsIntegralWhileSaturated) {
  for (const auto windup : {Pid::Windup::clamp, Pid::Windup::clamp_and_hold}) {
    Pid pid({1966, 393, 0}, windup);
    const auto step = [&pid](std::int32_t velocity) {
      return pid.update(7000 * kOfRpm, velocity, -255 * Pid::kOne, 255 * Pid::kOne);
    };
    for (int sample = 0; sample < 500; ++sample) (void)step(0);
    const double out = static_cast<double>(step(7100 * kOfRpm)) / Pid::kOne;
    if (windup == Pid::Windup::clamp_and_hold)
      EXPECT_LT(out, 60);  // what it had summed up before Kp e alone saturated
    else
      EXPECT_GT(out, 250);  // the published one is wound up
  }
}

TEST(Controller, AStepOfTheSetpointGivesNoKickOfTheDerivative) {
  Pid with({1966, 0, 3000}, Pid::Windup::clamp), without({1966, 0, 0}, Pid::Windup::clamp);
  const std::int32_t high = 255 * Pid::kOne;
  (void)with.update(0, 1600, -high, high);
  (void)without.update(0, 1600, -high, high);
  EXPECT_EQ(with.update(16'000, 1600, -high, high), without.update(16'000, 1600, -high, high));
}

}  // namespace controller_test
}  // namespace verisim::firmware
