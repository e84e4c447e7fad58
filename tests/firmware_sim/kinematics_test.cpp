// Mecanum kinematics and the gain of the float messages against their closed forms.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/base/random.hpp"
#include "firmware_sim/firmware/mecanum.hpp"

namespace verisim::firmware {
namespace kinematics_test {

/// RPM/16 of the motor for mm/s of the wheel's rim.
constexpr double kRpmPerMm = 64 * 60 / (2 * std::numbers::pi * 50) * 16;

std::array<double, 4> closed_form(double vx, double vy, double omega) {
  const double turn = 0.3 * omega;  // (l + w) = 0.300 m, omega in mrad/s
  return {kRpmPerMm * (vx - vy - turn), kRpmPerMm * (vx + vy + turn), kRpmPerMm * (vx + vy - turn),
          kRpmPerMm * (vx - vy + turn)};
}

// The factor is right to 4e-6, which makes 0.45 units at 7000 RPM, and half a unit is rounded.
TEST(Mecanum, FollowsTheClosedFormWithinReach) {
  RandomStream random(3, "kinematics_test");
  for (std::uint64_t i = 0; i < 3000; i += 3) {
    const auto draw = [&](std::uint64_t k, int bound) {
      return static_cast<int>(random.bits(i + k) % (2 * bound + 1)) - bound;
    };
    const int vx = draw(0, 190), vy = draw(1, 190), omega = draw(2, 600);
    const Setpoints at = setpoints_for(vx, vy, omega);
    const std::array<double, 4> expected = closed_form(vx, vy, omega);
    for (std::size_t wheel = 0; wheel < 4; ++wheel)
      EXPECT_NEAR(at.wheels[wheel], expected[wheel], 0.5 + 4e-6 * std::abs(expected[wheel]));
  }
}

TEST(Mecanum, TopSpeedIs573MmPerSecond) {
  EXPECT_NEAR(setpoints_for(572, 0, 0).wheels[0], 7000 * 16 * 572 / 572.687, 1);
  EXPECT_EQ(setpoints_for(574, 0, 0).wheels[0], 7000 * 16);
}

// Beyond reach each wheel keeps its share of the fastest; halving and rounding cost less than 1/4096 of it.
TEST(Mecanum, KeepsTheDirectionBeyondReach) {
  RandomStream random(5, "kinematics_test");
  for (std::uint64_t i = 0; i < 6000; i += 3) {
    const auto draw = [&](std::uint64_t k) { return static_cast<std::int16_t>(random.bits(i + k)); };
    const int vx = draw(0), vy = draw(1), omega = draw(2);
    const std::array<double, 4> wanted = closed_form(vx, vy, omega);
    double fastest = 0;
    for (const double wheel : wanted) fastest = std::max(fastest, std::abs(wheel));
    if (fastest < 7000 * 16) continue;
    const Setpoints at = setpoints_for(vx, vy, omega);
    for (std::size_t wheel = 0; wheel < 4; ++wheel)
      EXPECT_NEAR(at.wheels[wheel] / 112'000.0, wanted[wheel] / fastest, 1.0 / 4096) << vx << " " << vy << " " << omega;
  }
}

TEST(Mecanum, EveryCornerOfInt16StaysWithin7000Rpm) {
  constexpr int kCorners[] = {-32768, -1, 0, 1, 32767};
  for (const int vx : kCorners)
    for (const int vy : kCorners)
      for (const int omega : kCorners)
        for (const std::int32_t wheel : setpoints_for(vx, vy, omega).wheels) EXPECT_LE(std::abs(wheel), 112'000);
  for (const std::int32_t wheel : setpoints_for(kVelocityMax, -kVelocityMax, kVelocityMax).wheels)
    EXPECT_LE(std::abs(wheel), 112'000);
}

std::int32_t velocity_of(float error) {
  std::int32_t velocity = 12345;
  EXPECT_TRUE(velocity_for_error(error, velocity)) << error;
  return velocity;
}

// std::round rounds half away from zero, and float times 5000 is exact in double.
TEST(ErrorGain, IsExactlyFiveThousandForEveryKindOfFloat) {
  RandomStream random(9, "kinematics_test");
  for (std::uint64_t i = 0; i < 200'000; ++i) {
    const auto error = std::bit_cast<float>(static_cast<std::uint32_t>(random.bits(i)));
    if (std::isnan(error)) continue;
    const double expected = std::clamp<double>(std::round(5000.0 * error), -kVelocityMax, kVelocityMax);
    ASSERT_EQ(velocity_of(error), expected) << error;
  }
}

TEST(ErrorGain, RoundsBothDirectionsAlikeAndDoesNotWrap) {
  EXPECT_EQ(velocity_of(0.00011F), 1);  // 0.55 mm/s
  EXPECT_EQ(velocity_of(-0.00011F), -1);
  EXPECT_EQ(velocity_of(0.00009F), 0);
  EXPECT_EQ(velocity_of(7), 35'000);  // the published conversion to int16 gave -30536 here
  EXPECT_EQ(velocity_of(-0.0F), 0);
  EXPECT_EQ(velocity_of(std::numeric_limits<float>::denorm_min()), 0);
  EXPECT_EQ(velocity_of(std::numeric_limits<float>::infinity()), kVelocityMax);
  EXPECT_EQ(velocity_of(-std::numeric_limits<float>::infinity()), -kVelocityMax);
}

TEST(ErrorGain, RefusesNan) {
  std::int32_t velocity = 7;
  EXPECT_FALSE(velocity_for_error(std::numeric_limits<float>::quiet_NaN(), velocity));
  EXPECT_FALSE(velocity_for_error(std::bit_cast<float>(0xff800001U), velocity));
  EXPECT_EQ(velocity, 7);
}

}  // namespace kinematics_test
}  // namespace verisim::firmware
