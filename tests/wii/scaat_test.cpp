// The filter: what one measurement at a time buys.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/wii/head_filter.hpp"
#include "tests/wii/validation_runs.hpp"

namespace verisim::wii {
namespace {

TEST(HeadFilter, CovarianceGrowsWhileNothingIsSeenAndTheHeadStaysNear) {
  HeadFilter filter;
  filter.start({{0, 0, 1}, Quaterniond::Identity()}, 1e-6 * Matrix6d::Identity());
  double last = filter.position_variance();
  for (int i = 0; i < 100; ++i) {
    filter.predict(0.01, HeadFilter::View::none);
    EXPECT_GT(filter.position_variance(), last);
    last = filter.position_variance();
  }
  EXPECT_LT((filter.X_RH().position - Vector3d(0, 0, 1)).norm(), 0.01);
}

// One scalar of known variance on a known prior: 1 / (1/a + 1/b).
TEST(HeadFilter, WeighsPriorAndMeasurementByTheirVariances) {
  HeadFilter filter;
  filter.start({{0, 0, 1}, Quaterniond::Identity()}, 4e-4 * Matrix6d::Identity());
  EXPECT_TRUE(filter.correct({0, 0, 1}, Vector3d::Zero(), 0.02, 4e-4, 5));
  EXPECT_NEAR(filter.X_RH().position.z(), 1.01, 1e-12);
  EXPECT_NEAR(filter.covariance()(2, 2), 2e-4, 1e-12);
}

TEST(HeadFilter, RefusesWhatIsBeyondTheGate) {
  HeadFilter filter;
  filter.start({{0, 0, 1}, Quaterniond::Identity()}, 1e-6 * Matrix6d::Identity());
  EXPECT_FALSE(filter.correct({0, 0, 1}, Vector3d::Zero(), 1, 1e-6, 5));
  EXPECT_EQ(filter.X_RH().position.z(), 1);
}

TEST(Scaat, SmoothsWhatTheGeometricTrackerLetsThrough) {
  EXPECT_LT(row_of("scaat", "natural", "noisy").position.rms, row_of("geometric", "natural", "noisy").position.rms);
}

TEST(Scaat, WithThreeLedsSeesYaw) {
  const ValidationRow row = row_of("scaat/3", "natural-yaw", "noisy");
  EXPECT_LE(row.position.rms, 0.008);
  EXPECT_LE(row.orientation.rms_axis.y(), 1.5);
}

TEST(Scaat, IgnoresALamp) {
  EXPECT_LE(row_of("scaat", "natural", "lamp").position.max, 0.05);
}

TEST(Scaat, IsConsistentInNaturalMotion) {
  const ValidationRow row = row_of("scaat", "natural", "noisy");
  EXPECT_TRUE(row.consistent) << row.nees;
  EXPECT_GE(row.within_95, 0.9);
}

}  // namespace
}  // namespace verisim::wii
