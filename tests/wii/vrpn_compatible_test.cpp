// The tracker that does what VRPN's does, against what VRPN's did (reference/wii: recordings and UPSTREAM.md).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "engine/wii/tracker.hpp"
#include "tests/support/paths.hpp"
#include "tests/wii/recordings.hpp"

namespace verisim::wii::vrpn_compatible_test {
namespace {

std::string printed(double value) {
  return fmt::format("{:.10g}", value == 0 ? 0 : value);
}

class Recording : public testing::TestWithParam<const char*> {};

// The recordings print ten significant digits.
TEST_P(Recording, IsReproducedToTheLastPrintedDigit) {
  const std::vector<RecordedRow> rows = read_recording(GetParam());
  if (rows.empty()) GTEST_SKIP() << "no " << GetParam() << " in " << paths::in_shared_reference("wii");
  const std::unique_ptr<Tracker> tracker = make_tracker("vrpn-compatible", {});
  for (const RecordedRow& row : rows) {
    SCOPED_TRACE(row.t);
    const Report& report = tracker->update(row.t, row.channels);
    ASSERT_EQ(report.valid, row.lock);
    for (int i = 0; i < 3; ++i)
      ASSERT_EQ(printed(report.pose.position[i]), row.upstream[static_cast<std::size_t>(i)]) << "position " << i;
    for (int i = 0; i < 4; ++i)
      ASSERT_EQ(printed(report.pose.rotation.coeffs()[i]), row.upstream[static_cast<std::size_t>(3 + i)])
          << "quaternion " << i;
  }
}
INSTANTIATE_TEST_SUITE_P(Upstream, Recording, testing::Values("static_centre.csv", "sweep_x.csv"),
                         [](const auto& param) { return std::string(param.param).substr(0, 6); });

constexpr Channels kLevel = {0.75, 0, 0, 1, 609, 384, 4, 415, 384, 4, -1, -1, -1, -1, -1, -1};

// ORACLES section 3, slip 5: a constant 20 degrees reads 6.6, because only changed readings are averaged.
TEST(VrpnCompatible, ReadsAThirdOfAConstantTilt) {
  const std::unique_ptr<Tracker> tracker = make_tracker("vrpn-compatible", {});
  Channels tilted = kLevel;
  tilted[2] = -std::sin(20 * kDegree);
  tilted[3] = std::cos(20 * kDegree);
  for (int i = 0; i < 100; ++i) tracker->update(0.01 * i, tilted);
  const double angle = 2 * std::acos(tracker->heartbeat(1).pose.rotation.w()) / kDegree;
  EXPECT_NEAR(angle, 6.6, 0.1);
}

TEST(VrpnCompatible, KeepsALockOnStalePointsWhenSlotZeroVanishes) {
  const std::unique_ptr<Tracker> tracker = make_tracker("vrpn-compatible", {});
  tracker->update(0, kLevel);
  Channels without_first = kLevel;
  without_first[4] = without_first[5] = without_first[6] = -1;
  EXPECT_TRUE(tracker->update(0.01, without_first).valid);
}

TEST(VrpnCompatible, StaysHalfATurnWrongAfterASwap) {
  const std::unique_ptr<Tracker> tracker = make_tracker("vrpn-compatible", {});
  tracker->update(0, kLevel);
  Channels swapped = kLevel;
  std::swap(swapped[4], swapped[7]);
  EXPECT_NEAR(std::abs(tracker->update(0.01, swapped).pose.rotation.z()), 1, 1e-12);
}

}  // namespace
}  // namespace verisim::wii::vrpn_compatible_test
