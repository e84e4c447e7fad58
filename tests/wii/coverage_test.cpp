// Eq. 2.1 and 2.2, as printed and corrected, against a count with the virtual remote (ORACLES R7, slip 2).
#include "engine/wii/coverage.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace verisim::wii::coverage_test {
namespace {

constexpr double kSpacing = 0.15;

// 2 tan(21.5 deg) = 0.787821, less 0.15; times 2 tan(16 deg) = 0.573491.
TEST(Coverage, AreaAtOneMetreIsTheWorkedNumber) {
  EXPECT_NEAR(trackable_area({}, kSpacing, 1), 0.637821 * 0.573491, 1e-6);
  EXPECT_EQ(trackable_area({}, kSpacing, 0.1), 0);
}

// Simpson's rule is exact for the quadratic A(d).
TEST(Coverage, CorrectedVolumeIsTheIntegralOfTheArea) {
  const auto A = [](double d) { return trackable_area({}, kSpacing, d); };
  const double simpson = (2.0 - 0.4) / 6 * (A(0.4) + 4 * A(1.2) + A(2));
  EXPECT_NEAR(trackable_volume({}, kSpacing, 0.4, 2), simpson, 1e-14);
}

// Slip 2: eq. 2.2 has two thirds of the spacing's term.
TEST(Coverage, PrintedVolumeLacksAThirdOfTheSpacingTerm) {
  const double missing = kSpacing * pinned::tan(16 * kDegree) * (2 * 2 - 0.4 * 0.4) / 3;
  EXPECT_NEAR(trackable_volume_as_printed({}, kSpacing, 0.4, 2) - trackable_volume({}, kSpacing, 0.4, 2), missing,
              1e-14);
}

TEST(Coverage, CountAgreesWithTheAreaAndTheCorrectedVolumeOnly) {
  const Counted area = count_trackable_area({}, kSpacing, 1, 200'000, 1);
  EXPECT_NEAR(area.value, trackable_area({}, kSpacing, 1), 4 * area.standard_error);
  const Counted volume = count_trackable_volume({}, kSpacing, 0.4, 2, 200'000, 1);
  EXPECT_NEAR(volume.value, trackable_volume({}, kSpacing, 0.4, 2), 4 * volume.standard_error);
  EXPECT_GT(std::abs(volume.value - trackable_volume_as_printed({}, kSpacing, 0.4, 2)), 4 * volume.standard_error);
}

}  // namespace
}  // namespace verisim::wii::coverage_test
