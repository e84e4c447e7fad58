// The numbers, and upstream's beside them (in brackets there), from the validation's own runs.
#include <gtest/gtest.h>

#include "tests/wii/validation_runs.hpp"

namespace verisim::wii::numbers_test {
namespace {

TEST(Numbers, StaticAtOneMetreIsWithinHalfACentimetre) {
  EXPECT_LE(row_of("geometric", "static").position.rms, 0.005);
  EXPECT_NEAR(row_of("vrpn-compatible", "static").position.rms, 0.053, 0.001);
}

TEST(Numbers, DepthSweepIsWithinItsTarget) {
  EXPECT_LE(row_of("geometric", "sweep-z").position.rms, 0.0065);
  EXPECT_NEAR(row_of("vrpn-compatible", "sweep-z").position.rms, 0.065, 0.005);
}

TEST(Numbers, TiltedRemoteIsLevelled) {
  const ValidationRow row = row_of("geometric", "tilted");
  EXPECT_LE(row.position.rms, 0.0025);
  EXPECT_LE(row.orientation.rms_axis.z(), 0.2);
  EXPECT_GT(row_of("vrpn-compatible", "tilted").position.rms, 0.3);
}

TEST(Numbers, NaturalMotionWithTheFilterIsWithinItsTarget) {
  EXPECT_LE(row_of("scaat", "natural", "noisy").position.rms, 0.0045);
  EXPECT_GT(row_of("vrpn-compatible", "natural", "noisy").position.rms, 0.05);
}

TEST(Numbers, SwapMakesNoExcursion) {
  for (const char* tracker : {"geometric", "scaat", "three-led", "stereo"}) {
    SCOPED_TRACE(tracker);
    const ValidationRow row = row_of(tracker, "swap");
    EXPECT_LE(row.position.max, 0.05);
    EXPECT_LE(row.orientation.rms_axis.z(), 1);
    EXPECT_GE(row.availability, 0.995);
  }
}

TEST(Numbers, ThreeLedsTellYawFromDistance) {
  EXPECT_LE(row_of("three-led", "static").orientation.rms_axis.y(), 1);
  const ValidationRow row = row_of("three-led", "natural-yaw");
  EXPECT_LE(row.position.rms, 0.008);
  EXPECT_LE(row.orientation.rms_axis.y(), 1);
}

TEST(Numbers, WhereTwoLedsCannotKnowTheCovarianceSaysSo) {
  for (const char* tracker : {"geometric", "scaat"}) {
    SCOPED_TRACE(tracker);
    const ValidationRow row = row_of(tracker, "natural-yaw");
    EXPECT_GT(row.position.rms, 0.01) << "yaw did not disturb: this test would prove nothing";
    EXPECT_LE(row.nees, row.nees_upper);
  }
}

TEST(Numbers, OneLedDarkForHalfASecondStaysWithinItsBound) {
  const ValidationRow row = row_of("scaat", "dropout-one");
  EXPECT_LE(row.position.max, 0.03);
  EXPECT_GE(row.within_95, 0.95);
  EXPECT_EQ(row.valid, row.reports);
}

TEST(Numbers, BothLedsDarkForHalfASecondAreFlaggedAndReacquired) {
  for (const char* tracker : {"geometric", "scaat", "three-led", "stereo"}) {
    SCOPED_TRACE(tracker);
    const ValidationRow row = row_of(tracker, "dropout-both");
    EXPECT_EQ(row.false_validity, 0);
    EXPECT_LE(row.longest_return, 0.0101);
    EXPECT_GE(row.reacquired, 9);
    EXPECT_LE(row.position.max, 0.05);
  }
}

TEST(Numbers, NearlyEverySampleWithBothLedsInViewIsValid) {
  for (const Trajectory& path : trajectories())
    for (const char* tracker : {"geometric", "scaat", "three-led", "stereo"}) {
      SCOPED_TRACE(path.name + ", " + tracker);
      EXPECT_GE(row_of(tracker, path.name).availability, 0.995);
    }
}

}  // namespace
}  // namespace verisim::wii::numbers_test
