// From the handle and the tracker to a velocity: the published law, a tracker that is gone, and one that cannot be
// right.
#include "engine/robot/drive_law.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "engine/base/pinned_math.hpp"
#include "tests/support/random_inputs.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::robot::drive_law_test {
namespace {

using Vector2 = std::array<double, 2>;

// Published: neutral point x 0, z 0.55. The handle at x 0.1, z 0.35 is 0.1 to the right and 0.2 further away.
TEST(DriveLaw, ErrorIsHandleMinusNeutralPoint) {
  const DriveLaw law({});
  const Vector2 e = law.error_R({0.1, -0.35});
  EXPECT_NEAR(e[0], 0.1, test::tolerance(1e-15));
  EXPECT_NEAR(e[1], 0.2, test::tolerance(1e-15));
}

// Mounted a quarter turn to the left: the device's x is the robot's y.
TEST(DriveLaw, ErrorIsInTheRobotsCoordinates) {
  DriveLawSettings settings;
  settings.mount_yaw = pinned::kPi / 2;
  const Vector2 e = DriveLaw(settings).error_R({0.1, -0.35});
  EXPECT_NEAR(e[0], -0.2, test::tolerance(1e-15));
  EXPECT_NEAR(e[1], 0.1, test::tolerance(1e-15));
}

/// A base that follows its command with a lag, under a drive law and a tracker.
struct Rig {
  explicit Rig(const DriveLawSettings& settings = {}, const BaseTrackerSettings& tracking = {})
      : law(settings), tracker(tracking, 1, "art") {}

  void advance(double vx_F, double vy_F) {
    const TrackedBase& tracked = tracker.advance(pose);
    const double a = tracked.pose.theta, ca = std::cos(a), sa = std::sin(a);
    command = law.advance({ca * vx_F + sa * vy_F, -sa * vx_F + ca * vy_F, 0}, tracked, {0, -0.55}, {});
    law.in_force(command, tracked);
    const double share = is_powered ? 0.001 / 0.05 : 1;
    const PlanarTwist to = is_powered ? command : PlanarTwist();
    v.vx += (to.vx - v.vx) * share;
    v.vy += (to.vy - v.vy) * share;
    v.omega += (to.omega - v.omega) * share;
    const double c = std::cos(pose.theta), s = std::sin(pose.theta);
    way += std::sqrt(v.vx * v.vx + v.vy * v.vy) * 0.001;
    pose.x += (c * v.vx - s * v.vy) * 0.001;
    pose.y += (s * v.vx + c * v.vy) * 0.001;
    pose.theta += v.omega * 0.001 + torque * 0.001;
    law.report(notes);
    for (const RobotNotes::Note& note : notes) said += std::string(note.kind) + " " + note.text + "\n";
    notes.clear();
  }

  DriveLaw law;
  BaseTracker tracker;
  PlanarPose pose;
  PlanarTwist v, command;
  double torque = 0, way = 0;  ///< rad/s that a torque turns it; m that it went
  bool is_powered = true;
  RobotNotes notes;
  std::string said;
};

/// A person's way: there and back, in both directions, stops between.
Vector2 walk(int ms) {
  const double t = ms * 0.001;
  return {0.4 * std::sin(1.3 * t), ms % 7000 < 2000 ? 0.0 : 0.3 * std::sin(0.9 * t + 1)};
}

TEST(DriveLaw, TrustsARightTrackerHoweverThePersonWalks) {
  for (const std::uint64_t seed : test::seeds(20)) {
    SCOPED_TRACE(seed);
    test::Inputs inputs(seed);
    BaseTrackerSettings tracking;
    tracking.latency = inputs.between(0, 0.06);
    tracking.sigma_position = 0.002;
    tracking.sigma_yaw = 0.005;
    tracking.dropout_rate = 0.5;
    Rig rig({}, tracking);
    rig.pose.theta = inputs.between(-3, 3);
    const int start = static_cast<int>(inputs.between(0, 20'000));
    for (int ms = 0; ms < 30'000; ++ms) {
      const Vector2 v = walk(start + ms);
      rig.torque = ms % 5000 < 1500 ? 0.1 : 0;
      rig.advance(v[0], v[1]);
      ASSERT_FALSE(rig.law.is_stopped()) << ms;
    }
  }
}

// Swapped axes are found in half a second of walking, 0.15 m at most, and the robot then stands until it is started
// anew.
TEST(DriveLaw, StopsWhenAxesAreSwappedAndSaysSo) {
  Rig rig;
  for (int ms = 0; ms < 1000; ++ms) rig.advance(0, 0);
  rig.tracker.swap_axes(true);
  const double before = rig.way;
  for (int ms = 0; ms < 3000; ++ms) rig.advance(0.3, 0);
  EXPECT_TRUE(rig.law.is_stopped());
  EXPECT_EQ(rig.command.vx, 0);
  EXPECT_LT(rig.way - before, 0.20);
  EXPECT_NE(rig.said.find("another motion than the commanded one (swapped axes?): the robot stops"), std::string::npos);
  rig.tracker.swap_axes(false);
  rig.law.restart();
  for (int ms = 0; ms < 1000; ++ms) rig.advance(0.3, 0);
  EXPECT_FALSE(rig.law.is_stopped());
  EXPECT_GT(rig.command.vx, 0.29);
}

// On the diagonal x = y swapped axes show the same motion: nothing is found until the person turns.
TEST(DriveLaw, CannotSeeSwappedAxesOnTheDiagonal) {
  Rig rig;
  for (int ms = 0; ms < 500; ++ms) rig.advance(0, 0);
  rig.tracker.swap_axes(true);
  for (int ms = 0; ms < 1500; ++ms) rig.advance(0.2, 0.2);
  EXPECT_FALSE(rig.law.is_stopped());
  for (int ms = 0; ms < 4000; ++ms) rig.advance(0.3, 0);
  EXPECT_TRUE(rig.law.is_stopped());
}

// A yaw that runs the other way would make heading control turn the base away for ever.
TEST(DriveLaw, StopsWhenYawRunsTheOtherWay) {
  DriveLaw law({});
  double theta = 0.3;
  int ms = 0;
  for (; ms < 20'000 && !law.is_stopped(); ++ms) {
    const TrackedBase tracked{.pose = {0, 0, -theta}, .age = 0, .is_valid = true, .is_new = ms % 17 == 0};
    const PlanarTwist command = law.advance({}, tracked, {0, 0}, {});
    law.in_force(command, tracked);
    theta += command.omega * 0.001;
  }
  EXPECT_TRUE(law.is_stopped());
  EXPECT_LT(theta, 1.2) << "rad: less than a quarter of a turn too far";
}

// A torque turns the base by half a turn, faster than the robot can and against it (section 5.5): that is slip.
TEST(DriveLaw, TakesSlipForSlip) {
  Rig rig;
  for (int ms = 0; ms < 12'000; ++ms) {
    rig.torque = ms > 2000 && ms < 4000 ? 2 : 0;
    rig.advance(0.2, 0);
  }
  EXPECT_FALSE(rig.law.is_stopped());
  EXPECT_NEAR(rig.pose.theta, 0, 0.01) << "and is turned back";
}

// Motor power off: it stands, which is no reason to stop it, and it is said.
TEST(DriveLaw, SaysThatTheBaseDoesNotFollow) {
  Rig rig;
  rig.is_powered = false;
  for (int ms = 0; ms < 2000; ++ms) rig.advance(0.3, 0.1);
  EXPECT_FALSE(rig.law.is_stopped());
  EXPECT_NE(rig.said.find("robot does not follow its commands"), std::string::npos);
  rig.is_powered = true;
  for (int ms = 0; ms < 8000; ++ms) rig.advance(0.3, 0.1);
  EXPECT_FALSE(rig.law.is_stopped());
  EXPECT_NE(rig.said.find("robot follows its commands again"), std::string::npos);
}

// Gone for 2 s: after 0.25 s no rotation and 0.1 m/s at most, direction kept; when it is back, all as before.
TEST(DriveLaw, SlowsDownWhileTheTrackerIsGone) {
  BaseTrackerSettings tracking;
  tracking.outages = {{2, 4}};
  Rig rig({}, tracking);
  rig.torque = 0.02;
  for (int ms = 0; ms < 6000; ++ms) {
    rig.advance(0.4, 0.3);
    const double speed = std::sqrt(rig.command.vx * rig.command.vx + rig.command.vy * rig.command.vy);
    if ((ms > 30 && ms < 2200) || ms > 4030) {
      ASSERT_NEAR(speed, 0.5, 1e-12) << ms;
    }
    if (ms > 2240 && ms < 4019) {
      ASSERT_NEAR(speed, 0.1, 1e-12) << ms;
      ASSERT_EQ(rig.command.omega, 0) << ms;
    }
  }
  EXPECT_EQ(rig.said,
            "tracker is gone: no heading control, speed is limited\n"
            "tracker is back: heading control, no speed limit\n");
}

// The head stands 1 m in front of the handle and looks along x; the neutral point is ahead of the base, so is the base
// in the line. It turns until the line from its middle to the neutral point has 60 degrees to it.
TEST(DriveLaw, TurnsTheBaseOutOfTheLineOfSight) {
  DriveLawSettings settings;
  settings.neutral_D = {0.55, 0};
  settings.heading.clearance = pinned::kPi / 3;
  DriveLaw law(settings);
  double theta = 0;
  for (int ms = 0; ms < 10'000; ++ms) {
    // The base goes around the handle, which stands at the origin.
    const PlanarPose pose{-0.55 * std::cos(theta), -0.55 * std::sin(theta), theta};
    const TrackedBase tracked{.pose = pose, .age = 0, .is_valid = true, .is_new = true};
    theta += law.advance({}, tracked, {0.55, 0}, Vector2{-1, 0}).omega * 0.001;
  }
  EXPECT_NEAR(theta, pinned::kPi / 3, 1e-6);
}

}  // namespace
}  // namespace verisim::robot::drive_law_test
