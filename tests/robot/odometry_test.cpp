// Dead reckoning, speeds and slip from counts: against arcs, synthesized drives and the plant.
#include "engine/robot/odometry.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/robot/drive.hpp"
#include "tests/robot/plants.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::robot::odometry_test {
namespace {

using test::tolerance;

const WheelMap kNexusMap{counts_per_displacement(MecanumGeometry{}, kCountsPerWheelTurn)};

// A quarter circle of radius 2 to the left ends at (2, 2), turned by 90 degrees, whatever the pose that it begins at.
TEST(Moved, IsAnArc) {
  const PlanarTwist quarter{pinned::kPi, 0, pinned::kPi / 2};
  const PlanarPose end = moved({}, quarter);
  EXPECT_NEAR(end.x, 2, tolerance(1e-15));
  EXPECT_NEAR(end.y, 2, tolerance(1e-15));
  const PlanarPose other = moved({1, 1, pinned::kPi / 2}, quarter);
  EXPECT_NEAR(other.x, -1, tolerance(1e-15));
  EXPECT_NEAR(other.y, 3, tolerance(1e-15));
  EXPECT_NEAR(other.theta, pinned::kPi, tolerance(1e-15));
}

TEST(Moved, IsTheSameInOnePieceAndInManyAcrossItsSeries) {
  for (const double turn : {1e-9, 0.99e-8, 1.01e-8, 1e-4, 3.0}) {
    const PlanarPose whole = moved({}, {1, 0.5, turn});
    PlanarPose pieces;
    for (int i = 0; i < 64; ++i) pieces = moved(pieces, {1.0 / 64, 0.5 / 64, turn / 64});
    EXPECT_NEAR(pieces.x, whole.x, tolerance(1e-14));
    EXPECT_NEAR(pieces.y, whole.y, tolerance(1e-14));
  }
}

TEST(WheelMap, UndoesTheKinematics) {
  const PlanarTwist there{0.3, -0.2, 0.7};
  PerWheel counts = wheel_speeds({}, there);
  for (double& c : counts) c *= kCountsPerWheelTurn / pinned::kFullTurn;
  const PlanarTwist back = kNexusMap.displacement(counts);
  EXPECT_NEAR(back.vx, there.vx, tolerance(1e-14));
  EXPECT_NEAR(back.vy, there.vy, tolerance(1e-14));
  EXPECT_NEAR(back.omega, there.omega, tolerance(1e-14));
}

// Counts are whole: 0.1 mm of floor each, 0.17 mrad of a turn; in a square the turns' errors move its 1 m sides by 0.2
// mm.
TEST(Odometry, FindsTheEndOfSynthesizedDrives) {
  for (const std::string& path : drive_paths()) {
    SCOPED_TRACE(path);
    const DriveTrace drive = synthesize_drive(path, {});
    Odometry odometry(kNexusMap, {}, drive.samples.front().counts);
    for (const DriveSample& sample : drive.samples) {
      const PlanarPose pose = odometry.advance(sample.counts);
      ASSERT_NEAR(pose.x, sample.pose.x, 1e-3) << sample.t;
      ASSERT_NEAR(pose.y, sample.pose.y, 1e-3) << sample.t;
      ASSERT_NEAR(pose.theta, sample.pose.theta, 0.35e-3) << sample.t;
    }
  }
}

TEST(Drive, GoesWhereItsPathSays) {
  const auto end = [](const char* path) { return synthesize_drive(path, {{"length", 2}}).samples.back(); };
  EXPECT_NEAR(end("straight").pose.x, 2, tolerance(1e-15));
  EXPECT_EQ(end("straight").counts, (Counts{19557, 19557, 19557, 19557}));  // 2 m / (2 pi 0.05 m) * 3072 = 19556.96
  EXPECT_NEAR(end("strafe").pose.y, 2, tolerance(1e-15));
  EXPECT_NEAR(end("turn").pose.theta, pinned::kFullTurn, tolerance(1e-15));
  for (const char* closed : {"square", "circle"}) {
    EXPECT_NEAR(std::hypot(end(closed).pose.x, end(closed).pose.y), 0, tolerance(1e-14));
    EXPECT_NEAR(end(closed).pose.theta, pinned::kFullTurn, tolerance(1e-14));
  }
}

// The command is the derivative of the pose, in robot coordinates, in the middle of two samples, to their distance's
// square.
TEST(Drive, CommandsWhatItDoes) {
  const DriveTrace drive = synthesize_drive("circle", {{"rate", 1000}});
  for (std::size_t i = 1000; i + 1 < 6000; ++i) {
    const PlanarPose &a = drive.samples[i - 1].pose, &b = drive.samples[i + 1].pose;
    const double speed = std::hypot(b.x - a.x, b.y - a.y) / 2e-3;
    ASSERT_NEAR(speed, drive.samples[i].command.vx, 3e-4) << i;  // 0.5 m/s^2 changes by half a sample's step at corners
    ASSERT_NEAR((b.theta - a.theta) / 2e-3, drive.samples[i].command.omega, 6e-4) << i;
  }
}

TEST(Drive, RefusesWhatItDoesNotKnow) {
  const auto refusal = [](const char* path, const std::map<std::string, double>& parameters) {
    try {
      (void)synthesize_drive(path, parameters);
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::usage);
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_NE(refusal("sqare", {}).find("did you mean 'square'"), std::string::npos);
  EXPECT_NE(refusal("square", {{"lenght", 1}}).find("did you mean 'length'"), std::string::npos);
  EXPECT_NE(refusal("square", {{"speed", 0}}).find("speed is 0"), std::string::npos);
  EXPECT_NE(refusal("square", {{"rate", 1e9}}).find("samples"), std::string::npos);
  EXPECT_NE(refusal("square", {{"length", NAN}}).find("length is nan"), std::string::npos);
}

// A steady speed to one count per window: 1 / 20 ms = 50 counts a second.
TEST(CountRate, IsRightForAConstantSpeedToOneCountPerWindow) {
  CountRate rate(1e-3, 20e-3);
  for (int i = 0; i < 200; ++i) {
    const auto count = static_cast<std::int64_t>(std::floor(5.6 * i));
    const PerWheel speeds = rate.advance({count, -count, 0, 2 * count});
    if (i == 0) continue;
    const double resolution = 1 / (1e-3 * std::min(i, 20));
    EXPECT_NEAR(speeds[0], 5600, resolution);
    EXPECT_NEAR(speeds[1], -5600, resolution);
    EXPECT_EQ(speeds[2], 0);
    EXPECT_NEAR(speeds[3], 11200, 2 * resolution);
  }
}

/// After how many milliseconds slip is told, or -1.
int told_after(Plant& plant, const plants::Duties& duty, const Reaction& reaction, int milliseconds) {
  SlipDetector detector({}, kCountsPerWheelTurn, 1e-3);
  for (int i = 0; i < milliseconds; ++i) {
    plant.advance(duty, reaction);
    if (detector.advance(plant.state().counts)) return i;
  }
  return -1;
}

TEST(SlipDetector, IsSilentInDrivesThatGrip) {
  for (const plants::Duties& duty : {plants::Duties{120, 120, 120, 120}, {-120, 120, 120, -120}, {-90, 90, -90, 90}}) {
    Plant plant(PlantParameters{});
    EXPECT_EQ(told_after(plant, duty, {}, 1000), -1);
    EXPECT_EQ(told_after(plant, plants::kOff, {}, 500), -1);
    const auto back = [](int d) { return static_cast<std::int16_t>(-d); };
    EXPECT_EQ(told_after(plant, {back(duty[0]), back(duty[1]), back(duty[2]), back(duty[3])}, {}, 1000), -1);
  }
}

// A wheel that is lifted spins at its own speed. Latency: 0.15 s, and what the wheel takes to leave the others' speed.
TEST(SlipDetector, TellsWithin200MillisecondsThatAWheelSpins) {
  Plant plant(PlantParameters{});
  plants::start(plant, {120, 120, 120, 120}, 500);
  const Reaction lifts{{0, 0, 60}, Vector3d::Zero(), {0.3, 0.3, 0}};
  const int after = told_after(plant, {250, 120, 120, 120}, lifts, 1000);
  EXPECT_GT(after, 100);
  EXPECT_LT(after, 200);
}

}  // namespace
}  // namespace verisim::robot::odometry_test
