// The robot server: from errors to bytes and back, and what it does with what it should not get.
#include "engine/robot/robot_server.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/random_inputs.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::robot::robot_server_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// What the robot understands of what the server sends.
struct Robot {
  protocol::Receiver<protocol::ComputerToRobot> receiver;
  int starts = 0, ends = 0, velocities = 0, others = 0;
  std::optional<protocol::XYRotationIntVelocities> last;

  void operator()(const protocol::StartControl& /*m*/) { ++starts; }
  void operator()(const protocol::EndControl& /*m*/) { ++ends; }
  void operator()(const protocol::XYRotationIntVelocities& m) {
    ++velocities;
    last = m;
  }
  template <typename Other>
  void operator()(const Other& /*m*/) {
    ++others;
  }
  void hear(std::span<const std::uint8_t> bytes) {
    receiver.feed(bytes.data(), static_cast<std::uint32_t>(bytes.size()), *this);
  }
};

/// One millisecond of a simulation that has an error for its robot.
void drive(RobotServer& server, Robot& robot, double x, double y) {
  server.command(server.wanted(x, y));
  robot.hear(server.advance());
}

/// The published conversion: int16(error * gain + 0.5), wrapped as the x86 of the time wrapped it.
std::int16_t published(double error, double gain) {
  return static_cast<std::int16_t>(static_cast<std::int64_t>(error * gain + 0.5));
}

// 7 m at the published gain of 5000: 35000 is beyond int16. 35000 - 65536 = -30536 reverses the robot.
TEST(ToWire, SaturatesWhereThePublishedConversionWraps) {
  EXPECT_EQ(published(7, 5000), -30536);
  EXPECT_EQ(to_wire(35.0), 32767);
  EXPECT_EQ(published(1.5, 25000), -28036);
  EXPECT_EQ(to_wire(37.5), 32767);
  EXPECT_EQ(to_wire(-37.5), -32768);
  EXPECT_EQ(to_wire(std::numeric_limits<double>::infinity()), 32767);
}

// A velocity of 0.9 mm/s: the published conversion gives 1 ahead and 0 backwards.
TEST(ToWire, RoundsHalfAwayFromZeroOnBothSides) {
  EXPECT_EQ(published(0.9, 1), 1);
  EXPECT_EQ(published(-0.9, 1), 0);
  EXPECT_EQ(to_wire(0.0009), 1);
  EXPECT_EQ(to_wire(-0.0009), -1);
  EXPECT_EQ(to_wire(0.0005), 1);
  EXPECT_EQ(to_wire(-0.0005), -1);
  EXPECT_EQ(to_wire(-0.00049), 0);
  for (const std::uint64_t seed : test::seeds(200)) {
    const double v = test::Inputs(seed).between(-32, 32);
    EXPECT_EQ(to_wire(-v), -to_wire(v)) << seed;
  }
}

// Gain 5 /s: 20 mm of error are 100 mm/s.
TEST(RobotServer, SendsGainTimesErrorFiftyTimesASecond) {
  RobotServer server({});
  Robot robot;
  server.start();
  for (int ms = 0; ms < 1000; ++ms) drive(server, robot, 0.020, -0.010);
  EXPECT_EQ(robot.velocities, 50);
  EXPECT_EQ(robot.starts, 1);
  EXPECT_EQ(robot.last->x, 100);
  EXPECT_EQ(robot.last->y, -50);
  EXPECT_EQ(robot.last->rotation, 0);
}

TEST(RobotServer, GainChangesWhileItRunsAndIsLostWithTheProcess) {
  RobotServer server({});
  Robot robot;
  server.start();
  server.set_gain(10);
  for (int ms = 0; ms < 40; ++ms) drive(server, robot, 0.02, 0);
  EXPECT_EQ(robot.last->x, 200);
  server.set_gain(kNan);
  server.set_gain(-1);
  EXPECT_EQ(server.gain(), 10);
  EXPECT_EQ(server.counts().refused, 2U);
  server.kill();
  server.start();
  EXPECT_EQ(server.gain(), 5);
}

// 7000 RPM through 64:1 on 50 mm: 0.5727 m/s ahead. On the diagonal all of it goes to two wheels: half in each
// direction.
TEST(RobotServer, KeepsDirectionAtTopSpeed) {
  RobotServer server({});
  Robot robot;
  server.start();
  drive(server, robot, 7, 0);
  EXPECT_EQ(robot.last->x, 573);
  for (int ms = 0; ms < 20; ++ms) drive(server, robot, 7, 7);
  EXPECT_EQ(robot.last->x, 286);
  EXPECT_EQ(robot.last->y, 286);
  EXPECT_GT(server.counts().saturated, 0U);
}

TEST(RobotServer, NoWheelIsEverAskedForMoreThanItsSpeed) {
  RobotServer server({});
  for (const std::uint64_t seed : test::seeds(500)) {
    test::Inputs inputs(seed);
    const double scale = std::pow(10, inputs.between(-3, 300));
    const Vector3d v = inputs.vector(scale);
    const PlanarTwist u = server.within_reach({v.x(), v.y(), v.z()});
    double fastest = 0;
    for (const double w : wheel_speeds({}, u)) fastest = std::fmax(fastest, std::abs(w));
    EXPECT_LE(fastest, 11.4537 * (1 + 1e-14)) << seed;  // a dozen roundings
    EXPECT_NEAR(u.vx * (v.y() / scale), u.vy * (v.x() / scale), test::tolerance(1e-14)) << seed << ": direction";
  }
}

// An error that is no number: the last good velocity stays for 250 ms, then the robot is told to stop.
TEST(RobotServer, RefusesNanAndKeepsTheLastGoodVelocityForTheWatchdogsTimeOnly) {
  for (const double bad : {kNan, std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()}) {
    RobotServer server({});
    Robot robot;
    RobotNotes notes;
    server.start();
    for (int ms = 0; ms < 100; ++ms) drive(server, robot, 0.02, 0);
    server.report(notes);
    notes.clear();
    for (int ms = 0; ms < 240; ++ms) drive(server, robot, bad, 0);
    EXPECT_EQ(robot.last->x, 100);
    for (int ms = 0; ms < 40; ++ms) drive(server, robot, 0, bad);
    EXPECT_EQ(robot.last->x, 0);
    EXPECT_EQ(server.counts().refused, 280U);
    EXPECT_EQ(server.counts().expired, 1U);
    server.report(notes);
    ASSERT_EQ(notes.size(), 2U);
    EXPECT_STREQ(notes.begin()[0].text, "refuses commands that are no numbers");
    EXPECT_STREQ(notes.begin()[1].text, "has had no good command for the watchdog's time and stops the robot");
    for (int ms = 0; ms < 20; ++ms) drive(server, robot, 0.02, 0);
    EXPECT_EQ(robot.last->x, 100) << "goes on with good ones";
  }
}

// The simulation hangs: no calls at all but those of the clock.
TEST(RobotServer, SilentSimulationStopsTheRobotAfterTheWatchdogsTime) {
  RobotServer server({});
  Robot robot;
  server.start();
  for (int ms = 0; ms < 21; ++ms) drive(server, robot, 0.02, 0);
  int moving = 0;
  for (int ms = 0; ms < 1000; ++ms) {
    robot.hear(server.advance());
    moving += robot.last->x != 0 ? 1 : 0;
  }
  EXPECT_GE(moving, 230);
  EXPECT_LE(moving, 270);
  EXPECT_EQ(robot.velocities, 52)
      << "at 0, 20, ..., 1020 ms: it goes on saying so, so that the firmware's watchdog stays quiet";
}

TEST(RobotServer, LongestSilenceOnTheLineIsOnePeriodWhileItRuns) {
  RobotServer server({});
  Robot robot;
  server.start();
  int silence = 0, longest = 0;
  for (int ms = 0; ms < 5000; ++ms) {
    const int before = robot.velocities;
    drive(server, robot, 0, 0);
    silence = robot.velocities == before ? silence + 1 : 0;
    longest = std::max(longest, silence);
  }
  EXPECT_EQ(longest, 19);
}

TEST(RobotServer, KilledSaysNothingAndStoppedSaysSo) {
  RobotServer server({});
  Robot robot;
  server.start();
  for (int ms = 0; ms < 30; ++ms) drive(server, robot, 0.02, 0);
  server.kill();
  for (int ms = 0; ms < 300; ++ms) {
    server.command(server.wanted(0.02, 0));
    EXPECT_TRUE(server.advance().empty());
  }
  EXPECT_EQ(robot.ends, 0);
  server.start();
  drive(server, robot, 0.02, 0);
  EXPECT_EQ(robot.starts, 2);
  server.stop();
  for (int ms = 0; ms < 30; ++ms) robot.hear(server.advance());
  EXPECT_EQ(robot.ends, 1);
}

template <typename Message>
std::vector<TimedByte> frame(const Message& message) {
  std::uint8_t bytes[64];
  const std::uint8_t count = protocol::encode<protocol::RobotToComputer>(message, bytes);
  std::vector<TimedByte> timed;
  for (std::uint8_t i = 0; i < count; ++i) timed.push_back({i, bytes[i]});
  return timed;
}

TEST(RobotServer, ReadsWhatTheRobotReports) {
  RobotServer server({});
  server.start();
  EXPECT_TRUE(std::isinf(server.telemetry().age));
  protocol::CurrentWheelSetpoints setpoints;
  protocol::CurrentWheelVelocities velocities;
  protocol::CurrentPWMOutput pwm;
  for (int i = 0; i < 4; ++i) {
    setpoints.wheels[i] = static_cast<std::int16_t>(1000 * i - 1500);
    velocities.wheels[i] = static_cast<std::int16_t>(-7 * i);
    pwm.wheels[i] = static_cast<std::int16_t>(255 - 100 * i);
  }
  std::vector<TimedByte> bytes = frame(setpoints);
  for (const TimedByte& byte : frame(velocities)) bytes.push_back(byte);
  bytes.push_back({0, 0x01});  // an SOH too many: the frame behind it is found all the same
  for (const TimedByte& byte : frame(pwm)) bytes.push_back(byte);
  for (std::size_t i = 0; i < bytes.size(); i += 5) {  // in pieces
    server.receive(std::span(bytes).subspan(i, std::min<std::size_t>(5, bytes.size() - i)));
    (void)server.advance();
  }
  const Telemetry telemetry = server.telemetry();
  EXPECT_EQ(telemetry.setpoint, (std::array<std::int16_t, 4>{-1500, -500, 500, 1500}));
  EXPECT_EQ(telemetry.velocity, (std::array<std::int16_t, 4>{0, -7, -14, -21}));
  EXPECT_EQ(telemetry.pwm, (std::array<std::int16_t, 4>{255, 155, 55, -45}));
  EXPECT_EQ(server.counts().reports, 3U);
  server.kill();
  EXPECT_TRUE(std::isinf(server.telemetry().age));
  server.start();
  server.receive(frame(pwm));
  EXPECT_EQ(server.telemetry().pwm[0], 255) << "found again";
}

// The robot was reset in mid-drive: its setpoints are 0 and stay so until StartControl.
TEST(RobotServer, StartsARobotAgainThatWasReset) {
  RobotServer server({});
  Robot robot;
  server.start();
  protocol::CurrentWheelSetpoints setpoints{{{500, 500, 500, 500}}};
  for (int ms = 0; ms < 5000; ++ms) {
    if (ms == 2000) setpoints = {};
    if (robot.starts == 2) setpoints = {{{500, 500, 500, 500}}};
    if (ms % 20 == 0) server.receive(frame(setpoints));
    drive(server, robot, 0.02, 0);
    EXPECT_EQ(robot.starts, ms < 2499 ? 1 : 2) << ms;
  }
  EXPECT_EQ(server.counts().starts, 2U);
}

// A stuck wheel: the firmware stops all four at once and does so again after every StartControl.
TEST(RobotServer, StartsAFaultyRobotThreeTimesAndNoMore) {
  RobotServer server({});
  Robot robot;
  RobotNotes notes;
  server.start();
  for (int ms = 0; ms < 20'000; ++ms) {
    if (ms % 20 == 0) server.receive(frame(protocol::CurrentWheelSetpoints{}));
    drive(server, robot, 0.02, 0);
  }
  EXPECT_EQ(robot.starts, 1 + 3);
  server.report(notes);
  ASSERT_EQ(notes.size(), 2U);
  EXPECT_STREQ(notes.begin()[1].text, "is not obeyed: the robot was reset, or has found a fault");
}

// A robot that stands because it is told to stand is no reason for StartControl.
TEST(RobotServer, LetsARobotStandThatIsToldTo) {
  RobotServer server({});
  Robot robot;
  server.start();
  for (int ms = 0; ms < 5000; ++ms) {
    if (ms % 20 == 0) server.receive(frame(protocol::CurrentWheelSetpoints{}));
    drive(server, robot, 0, 0);
  }
  EXPECT_EQ(robot.starts, 1);
}

TEST(RobotServer, SaysThatItHearsNothingFromTheRobot) {
  RobotServer server({});
  RobotNotes notes;
  Robot robot;
  server.start();
  for (int ms = 0; ms < 600; ++ms) drive(server, robot, 0, 0);
  server.report(notes);
  ASSERT_EQ(notes.size(), 2U);
  EXPECT_STREQ(notes.begin()[0].text, "is there");
  EXPECT_STREQ(notes.begin()[1].text, "hears nothing from the robot");
}

TEST(RobotServer, FloodOfNoiseIsRejectedAndCounted) {
  RobotServer server({});
  Robot robot;
  server.start();
  const RandomStream noise(1, "noise");
  std::uint64_t k = 0;
  for (int ms = 0; ms < 2000; ++ms) {
    std::vector<TimedByte> bytes;
    for (std::uint32_t i = 0; i < 12; ++i) bytes.push_back({i, static_cast<std::uint8_t>(noise.bits(k++) % 6)});
    server.receive(bytes);
    drive(server, robot, 0.02, 0);
  }
  EXPECT_EQ(robot.last->x, 100);
  server.kill();
  EXPECT_GT(server.counts().rejected, 1000U);
}

TEST(RobotServer, RefusesSettingsOutOfRange) {
  test::expect_refused([] { return RobotServer({.gain = -1}).gain(); }, "robot server: gain is -1");
  test::expect_refused([] { return RobotServer({.send_period = 0}).gain(); }, "send_period is 0 s");
  test::expect_refused([] { return RobotServer({.watchdog = kNan}).gain(); }, "watchdog is nan s");
  test::expect_refused([] { return RobotServer({.wheel_speed = 0}).gain(); }, "wheel_speed is 0 rad/s");
}

}  // namespace
}  // namespace verisim::robot::robot_server_test
