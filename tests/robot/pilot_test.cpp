// The host's side over two serial lines, with a robot that understands the protocol and follows with a lag.
#include "engine/robot/pilot.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/support/random_inputs.hpp"

namespace verisim::robot::pilot_test {
namespace {

/// As the firmware states it: off until StartControl, watchdog of 250 ms, a report every 20 ms.
class Robot {
 public:
  void operator()(const protocol::StartControl& /*m*/) { is_on = true, silent_ms = 0, target = {}; }
  void operator()(const protocol::EndControl& /*m*/) { is_on = false; }
  void operator()(const protocol::XYRotationIntVelocities& m) {
    silent_ms = 0;
    target = {m.x / 1000.0, m.y / 1000.0, m.rotation / 1000.0};
  }
  template <typename Other>
  void operator()(const Other& /*m*/) {}

  std::span<const TimedByte> advance(std::span<const TimedByte> bytes) {
    ++silent_ms;
    for (const TimedByte& byte : bytes) receiver.feed(&byte.value, 1, *this);
    const PlanarTwist to = is_on && silent_ms < 250 ? target : PlanarTwist();
    v.vx += (to.vx - v.vx) * 0.001 / 0.08;
    v.vy += (to.vy - v.vy) * 0.001 / 0.08;
    v.omega += (to.omega - v.omega) * 0.001 / 0.08;
    const double c = std::cos(pose.theta), s = std::sin(pose.theta);
    pose.x += (c * v.vx - s * v.vy) * 0.001;
    pose.y += (s * v.vx + c * v.vy) * 0.001;
    pose.theta += v.omega * 0.001;
    out.clear();
    if (++ms % 20 != 0) return out;
    protocol::CurrentWheelSetpoints m;
    const PerWheel w = wheel_speeds({}, to);
    for (std::size_t i = 0; i < 4; ++i) m.wheels[i] = static_cast<std::int16_t>(std::lround(w[i] * 64 * 9.5493));
    std::uint8_t frame[64];
    const std::uint8_t count = protocol::encode<protocol::RobotToComputer>(m, frame);
    for (std::uint8_t i = 0; i < count; ++i) out.push_back({1360U * i, frame[i]});
    return out;
  }

  protocol::Receiver<protocol::ComputerToRobot> receiver;
  bool is_on = false;
  int silent_ms = 0, ms = 0;
  PlanarTwist target, v;
  PlanarPose pose;
  std::vector<TimedByte> out;
};

struct Rig {
  explicit Rig(const PilotSettings& settings = {}, const SerialLineSettings& line = {},
               const BaseTrackerSettings& tracking = {})
      : pilot(settings), tracker(tracking, 1, "art"), up(line, 1, "up"), down(line, 1, "down") {
    pilot.start();
  }

  /// One millisecond with the hand at a place of the floor.
  void advance(double hand_x, double hand_y) {
    const TrackedBase& tracked = tracker.advance(robot.pose);
    const double c = std::cos(robot.pose.theta), s = std::sin(robot.pose.theta);
    const double dx = hand_x - robot.pose.x, dy = hand_y - robot.pose.y;
    up.send(pilot.advance({c * dx + s * dy, -s * dx + c * dy - 0.55}, {}, tracked));
    down.send(robot.advance(up.advance()));
    pilot.receive(down.advance());
    pilot.report(notes);
    tracker.report(notes);
    up.report(notes);
    down.report(notes);
    for (const RobotNotes::Note& note : notes) said += std::string(note.kind) + " " + note.text + "\n";
    notes.clear();
  }
  [[nodiscard]] bool has_said(const char* text) const { return said.find(text) != std::string::npos; }

  Pilot pilot;
  BaseTracker tracker;
  SerialLine up, down;
  Robot robot;
  RobotNotes notes;
  std::string said;
};

// A hand at rest half a metre off: the base goes there and stays. To 1 mm/s of rounding over 5 /s: 0.2 mm.
TEST(Pilot, BringsTheBaseUnderTheHand) {
  Rig rig;
  for (int ms = 0; ms < 5000; ++ms) rig.advance(0.4, -0.3);
  EXPECT_NEAR(rig.robot.pose.x, 0.4, 0.0004);
  EXPECT_NEAR(rig.robot.pose.y, -0.3, 0.0004);
  EXPECT_NEAR(rig.robot.pose.theta, 0, 0.005);
  EXPECT_LT(rig.pilot.server().telemetry().age, 0.03);
  EXPECT_EQ(rig.pilot.server().counts().starts, 1U);
}

// A steady 0.3 m/s at a gain of 5 /s is followed 60 mm behind: the law is proportional.
TEST(Pilot, FollowsAtADistanceOfSpeedOverGain) {
  Rig rig;
  for (int ms = 0; ms < 5000; ++ms) rig.advance(0.0003 * ms, 0);
  EXPECT_NEAR(rig.pilot.error_R()[0], 0.3 / 5, 0.002);
}

TEST(Pilot, ServerIsKilledAndStartedInMidDrive) {
  Rig rig;
  for (int ms = 0; ms < 2000; ++ms) rig.advance(0.0003 * ms, 0);
  EXPECT_GT(rig.robot.v.vx, 0.25);
  rig.pilot.kill();
  for (int ms = 0; ms < 1000; ++ms) rig.advance(0.6, 0);
  EXPECT_LT(rig.robot.v.vx, 0.001) << "the firmware's watchdog";
  rig.pilot.start();
  for (int ms = 0; ms < 3000; ++ms) rig.advance(0.6, 0);
  EXPECT_NEAR(rig.robot.pose.x, 0.6, 0.0004);
  EXPECT_LT(rig.pilot.server().telemetry().age, 0.03);
  EXPECT_TRUE(rig.has_said("robot server is gone"));
}

TEST(Pilot, RobotIsResetInMidDrive) {
  Rig rig;
  for (int ms = 0; ms < 2000; ++ms) rig.advance(0.0003 * ms, 0);
  rig.robot.is_on = false;
  rig.robot.receiver = {};
  for (int ms = 2000; ms < 8000; ++ms) rig.advance(0.0003 * ms, 0);
  EXPECT_NEAR(rig.robot.v.vx, 0.3, 0.01);
  EXPECT_TRUE(rig.has_said("is not obeyed"));
  EXPECT_TRUE(rig.has_said("is obeyed again"));
}

TEST(Pilot, LineIsCutAndMended) {
  Rig rig;
  for (int ms = 0; ms < 2000; ++ms) rig.advance(0.0003 * ms, 0);
  rig.up.plug(false);
  rig.down.plug(false);
  for (int ms = 0; ms < 2000; ++ms) rig.advance(0.6, 0.2);
  EXPECT_LT(std::abs(rig.robot.v.vx), 0.001);
  EXPECT_TRUE(rig.has_said("hears nothing from the robot"));
  EXPECT_TRUE(rig.has_said("serial line loses bytes"));
  rig.up.plug(true);
  rig.down.plug(true);
  for (int ms = 0; ms < 3000; ++ms) rig.advance(0.6, 0.2);
  EXPECT_NEAR(rig.robot.pose.y, 0.2, 0.0004);
  EXPECT_TRUE(rig.has_said("hears the robot again"));
}

// 2 % of bytes lost and 0.2 % of bits inverted: two of five frames do not come through, the others carry the robot.
TEST(Pilot, GoesOnOverALineThatIsBad) {
  Rig rig({}, {.loss = 0.02, .corruption = 0.002});
  for (int ms = 0; ms < 5000; ++ms) rig.advance(0.4, -0.3);
  EXPECT_NEAR(rig.robot.pose.x, 0.4, 0.001);
  EXPECT_NEAR(rig.robot.pose.y, -0.3, 0.001);
  EXPECT_GT(rig.robot.receiver.received().rejected, 20U);
}

// 57,600 against 115,200: nothing that comes through is a frame. The robot stands, both ends count and say it.
TEST(Pilot, StandsWhenBaudRatesDoNotMatch) {
  Rig rig({}, {.baud = 57'600, .receiver_baud = 115'200});
  for (int ms = 0; ms < 3000; ++ms) rig.advance(0.4, -0.3);
  EXPECT_EQ(rig.robot.pose.x, 0);
  EXPECT_EQ(rig.robot.receiver.received().accepted, 0U);
  EXPECT_GT(rig.up.counts().framing_errors, 100U);
  EXPECT_TRUE(rig.has_said("hears nothing from the robot"));
}

TEST(Pilot, StopsForAHandleThatIsNoNumberAndGoesOn) {
  Rig rig;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (int ms = 0; ms < 1000; ++ms) rig.advance(0.0003 * ms, 0);
  for (int ms = 0; ms < 1500; ++ms) rig.advance(kNan, 0);
  EXPECT_LT(std::abs(rig.robot.v.vx), 0.001);
  EXPECT_TRUE(std::isfinite(rig.robot.pose.x));
  EXPECT_TRUE(rig.has_said("refuses commands that are no numbers"));
  for (int ms = 0; ms < 3000; ++ms) rig.advance(0.5, 0);
  EXPECT_NEAR(rig.robot.pose.x, 0.5, 0.0004);
}

// The hand pulls through the wall at the highest gains: the disc of 0.27 m never reaches x = 1, the hand feels a limit.
TEST(Pilot, WallsHoldAtAnyGain) {
  for (const double gain : {1.0, 5.0, 25.0, 1000.0}) {
    PilotSettings settings;
    settings.walls.emplace().corners = rectangle(-1, 1, -1, 1);
    settings.server.gain = gain;
    BaseTrackerSettings tracking;
    tracking.outages = {{1.2, 1.7}, {3, 5}};
    Rig rig(settings, {}, tracking);
    double furthest = 0;
    for (int ms = 0; ms < 12'000; ++ms) {
      rig.advance(1.2, 0.0001 * ms);
      furthest = std::fmax(furthest, std::fmax(rig.robot.pose.x, rig.robot.pose.y));
      if (ms == 5500) rig.pilot.kill();
      if (ms == 5600) rig.pilot.start();
    }
    EXPECT_LT(furthest + 0.27, 1) << gain;
    EXPECT_GT(furthest + 0.27, 0.90) << gain;
    EXPECT_LT(rig.pilot.limit_force_R()[0], -7) << gain << ": two walls at once, 10 N between them";
    EXPECT_TRUE(rig.has_said("walls hold the base back"));
  }
}

// Swapped axes are found by what the robot reports, in 0.2 m of way; the walls of a room 0.7 m away are not reached.
TEST(Pilot, SwappedAxesStopTheRobot) {
  Rig rig;
  for (int ms = 0; ms < 500; ++ms) rig.advance(0, 0);
  rig.tracker.swap_axes(true);
  for (int ms = 0; ms < 4000; ++ms) rig.advance(0.0003 * ms, 0);
  EXPECT_TRUE(rig.pilot.drive().is_stopped());
  EXPECT_LT(rig.robot.pose.x, 0.2);
  EXPECT_TRUE(rig.has_said("swapped axes?"));
}

TEST(Pilot, SameInputsGiveTheSameBits) {
  const auto end = [] {
    PilotSettings settings;
    settings.walls.emplace().corners = rectangle(-1, 1, -1, 1);
    BaseTrackerSettings tracking;
    tracking.dropout_rate = 1;
    Rig rig(settings, {.loss = 0.01, .corruption = 0.001}, tracking);
    test::Inputs inputs(1);
    for (int ms = 0; ms < 5000; ++ms) rig.advance(inputs.between(-1, 2), inputs.between(-2, 1));
    return std::array{rig.robot.pose.x, rig.robot.pose.y, rig.robot.pose.theta};
  };
  EXPECT_EQ(end(), end());
}

}  // namespace
}  // namespace verisim::robot::pilot_test
