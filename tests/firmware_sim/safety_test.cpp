// What goes wrong around the robot: it stops or goes on safely, and its reports say so.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "engine/base/random.hpp"
#include "firmware_sim/firmware/robot.hpp"
#include "tests/firmware_sim/bench_robot.hpp"

namespace verisim::firmware {
namespace safety_test {

using bench::Bench;
using bench::Motor;
constexpr std::array<std::int16_t, 4> kNothing{};

Bench driving(std::int16_t vx = 300) {
  Bench b(make_host_board());
  for (Motor& motor : b.robot.motors) motor.tau_s = 0.06;
  b.line.send(protocol::StartControl{});
  b.drive(protocol::XYIntVelocities{vx, 0}, 500);
  EXPECT_NE(b.line.heard.setpoints, kNothing);
  return b;
}

bool is_still(const Bench& b) {
  for (const Motor& motor : b.robot.motors)
    if (std::abs(motor.rpm) > 30) return false;
  return b.board->duty() == kNothing && b.line.heard.setpoints == kNothing;
}

TEST(Safety, DoesNothingUntilStartControl) {
  Bench b(make_host_board());
  b.drive(protocol::XYIntVelocities{300, 0}, 300);
  EXPECT_TRUE(is_still(b));
  b.line.send(protocol::StartControl{});
  b.run(50);
  EXPECT_TRUE(is_still(b)) << "what it heard while it was off is not kept";
  b.drive(protocol::XYIntVelocities{300, 0}, 300);
  EXPECT_GT(b.robot.motors[0].rpm, 3000);
}

TEST(Safety, EndControlLeavesTheMotorsWithoutPower) {
  Bench b = driving();
  b.line.send(protocol::EndControl{});
  b.run(30);
  EXPECT_EQ(b.board->duty(), kNothing);
  b.run(30);
  EXPECT_EQ(b.line.heard.setpoints, kNothing);
}

TEST(Safety, SilenceStopsItSmoothlyAndTheNextCommandGoesOn) {
  Bench b = driving();
  std::int16_t last = b.line.heard.setpoints[0];
  int began_ms = -1, ended_ms = -1;
  for (int ms = 0; ms < 1000; ++ms) {
    b.millisecond();
    const std::int16_t now = b.line.heard.setpoints[0];
    ASSERT_LE(now, last);
    ASSERT_GE(now, last - 3667 * 4 / kStopSteps - 20) << "four steps of the ramp between two reports";
    if (began_ms < 0 && now < last) began_ms = ms;
    if (ended_ms < 0 && now == 0) ended_ms = ms;
    last = now;
  }
  // driving() spoke 49 ms before; a report is up to 20 ms late, its bytes take 4.
  EXPECT_NEAR(began_ms, kWatchdogMs - 49, 35);
  EXPECT_NEAR(ended_ms - began_ms, kStopSteps * kSampleMs, 25);
  EXPECT_TRUE(is_still(b));
  b.drive(protocol::XYIntVelocities{300, 0}, 300);
  EXPECT_NEAR(b.robot.motors[0].rpm, 3667, 200);
}

TEST(Safety, ANanIsNotHeard) {
  Bench b = driving();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  b.drive(protocol::XYFloatError{kNan, 0}, 100);
  EXPECT_NEAR(b.line.heard.setpoints[0], 3667, 1) << "what was commanded before is still in force";
  b.drive(protocol::XYRotationFloatError{0, 0, kNan}, 700);
  EXPECT_TRUE(is_still(b)) << "and it does not feed the watchdog";
}

TEST(Safety, WrongChecksumsAreNotHeard) {
  Bench b = driving();
  std::uint8_t frame[32];
  const std::uint8_t length = protocol::encode<protocol::ComputerToRobot>(protocol::XYIntVelocities{-500, 0}, frame);
  ++frame[length - 2];
  for (int i = 0; i < 20; ++i) {
    b.line.send_bytes({frame, length});
    b.run(40);
  }
  EXPECT_TRUE(is_still(b));
}

TEST(Safety, NulBytesAndTruncatedFramesBetweenCommandsDoNoHarm) {
  Bench b = driving();
  for (int i = 0; i < 20; ++i) {
    const std::uint8_t rubbish[] = {0, 0, 0, 1, 0, 2, 0, 0};  // a frame of 14 bytes that ends after 5
    b.line.send_bytes(rubbish);
    b.drive(protocol::XYIntVelocities{300, 0}, 50);
  }
  EXPECT_NEAR(b.line.heard.setpoints[0], 3667, 1);
}

TEST(Safety, AFloodOfCommandsAtTheLinesRateIsFollowed) {
  Bench b = driving();
  for (int ms = 0; ms < 1000; ++ms) {
    b.line.send(protocol::XYIntVelocities{static_cast<std::int16_t>(ms % 2 == 0 ? 300 : 301), 0});
    b.millisecond();
  }
  EXPECT_NEAR(b.line.heard.setpoints[0], 3667, 13);
  EXPECT_EQ(b.board->load().bytes_lost, 0U);
  EXPECT_GT(b.line.heard.reports, 50);
}

TEST(Safety, MoreBytesThanAnyLineCarriesAreLostAndCounted) {
  Bench b = driving();
  const std::vector<TimedByte> flood(1000, TimedByte{0, 1});
  b.board->advance({}, flood);
  EXPECT_EQ(b.board->load().bytes_lost, 1000U - 63);
  b.run(100);
  b.drive(protocol::XYIntVelocities{300, 0}, 200);
  EXPECT_NEAR(b.line.heard.setpoints[0], 3667, 1);
}

// At another baud rate the bytes are anything. None in a hundred streams makes it move, and it has stopped.
TEST(Safety, GarbageOfAnotherBaudRateStopsIt) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Bench b = driving();
    RandomStream random(seed, "safety_test");
    std::uint64_t drawn = 0;
    for (int ms = 0; ms < 700; ++ms) {
      std::uint8_t bytes[11];
      for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.bits(drawn++));
      b.line.send_bytes(bytes);
      b.millisecond();
    }
    ASSERT_TRUE(is_still(b)) << seed;
  }
}

TEST(Safety, AResetInMidDriveForgetsEverythingUntilStartControl) {
  Bench b = driving();
  b.board->reset();
  EXPECT_EQ(b.board->duty(), kNothing);
  b.drive(protocol::XYIntVelocities{300, 0}, 500);
  EXPECT_TRUE(is_still(b)) << "setpoints 0 against the command: the computer sees that it must start it again";
  b.line.send(protocol::StartControl{});
  b.drive(protocol::XYIntVelocities{300, 0}, 300);
  EXPECT_NEAR(b.robot.motors[0].rpm, 3667, 200);
}

TEST(Safety, WithoutPowerItDoesNothingAndHearsNothing) {
  Bench b = driving();
  b.board->set_powered(false);
  EXPECT_EQ(b.board->duty(), kNothing);
  const int reports = b.line.heard.reports;
  b.line.send(protocol::StartControl{});
  b.drive(protocol::XYIntVelocities{300, 0}, 300);
  EXPECT_EQ(b.board->duty(), kNothing);
  EXPECT_EQ(b.line.heard.reports, reports);
  b.board->set_powered(true);
  b.drive(protocol::XYIntVelocities{300, 0}, 300);
  EXPECT_TRUE(is_still(b));
  EXPECT_GT(b.line.heard.reports, reports);
}

/// How far the wheels that still turn come, from the fault until all stand. In turns of the motor.
double turns_until_still(Bench& b, std::int16_t vx) {
  const double before = b.robot.motors[1].counts;
  b.drive(protocol::XYIntVelocities{vx, 0}, 2500);
  EXPECT_TRUE(is_still(b)) << "all four, though the command goes on";
  return (b.robot.motors[1].counts - before) / 48;
}

TEST(Safety, AStalledMotorStopsAllFour) {
  Bench b = driving();
  b.robot.motors[0].is_stalled = true;
  EXPECT_LT(turns_until_still(b, 300), 80);  // 3667 RPM for 0.5 s and what it takes to drive hard: 0.4 m
  b.robot.motors[0].is_stalled = false;
  b.drive(protocol::XYIntVelocities{300, 0}, 300);
  EXPECT_TRUE(is_still(b)) << "until StartControl";
  b.line.send(protocol::StartControl{});
  b.drive(protocol::XYIntVelocities{300, 0}, 300);
  EXPECT_NEAR(b.robot.motors[0].rpm, 3667, 200);
}

TEST(Safety, ADeadEncoderStopsAllFour) {
  Bench b = driving();
  b.robot.motors[2].encoder_is_dead = true;
  EXPECT_LT(turns_until_still(b, 300), 80);
  Bench from_standstill(make_host_board());
  from_standstill.robot.motors[0].encoder_is_dead = true;
  from_standstill.line.send(protocol::StartControl{});
  from_standstill.run(5);
  EXPECT_LT(turns_until_still(from_standstill, 50), 30);
}

TEST(Safety, AReversedEncoderStopsAllFour) {
  Bench b(make_host_board());
  b.robot.motors[3].encoder_is_reversed = true;
  b.line.send(protocol::StartControl{});
  b.run(5);
  EXPECT_LT(turns_until_still(b, 100), 20);
}

TEST(Safety, ReversingAtFullSpeedIsNoFault) {
  Bench b = driving(570);
  for (int i = 0; i < 4; ++i)
    b.drive(protocol::XYIntVelocities{static_cast<std::int16_t>(i % 2 == 0 ? -570 : 570), 0}, 600);
  EXPECT_GT(b.robot.motors[0].rpm, 5000);
}

}  // namespace safety_test
}  // namespace verisim::firmware
