// Three LEDs, and two remotes.
#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "engine/wii/tracker.hpp"
#include "engine/wii/trajectories.hpp"
#include "tests/wii/validation_runs.hpp"

namespace verisim::wii::multi_point_test {
namespace {

RemoteSettings ideal(const LedLayout& leds) {
  RemoteSettings settings;
  settings.whole_pixels = false;
  settings.leds.clear();
  for (int i = 0; i < leds.count; ++i) settings.leds.push_back(Led{leds.p_H[static_cast<std::size_t>(i)]});
  return settings;
}

// Without noise only the prior that heads are upright pulls, by (0.2 deg / 18 deg)^2 of the yaw at most.
TEST(ThreeLed, FindsAnyTurnedHeadAtOnce) {
  TrackerSettings settings;
  settings.leds = LedLayout::triangle();
  for (const double yaw : {-30.0, -10.0, 0.0, 10.0, 30.0})
    for (const double pitch : {-15.0, 0.0, 15.0})
      for (const double tilt : {0.0, 15.0}) {
        SCOPED_TRACE(testing::Message() << yaw << ", " << pitch << ", " << tilt);
        Situation s;
        s.X_WR = tilted_remote(tilt * kDegree, -tilt * kDegree);
        s.X_WH = {s.X_WR * Vector3d(0.1, 0.05, 1), head_rotation(yaw * kDegree, pitch * kDegree, 0.1)};
        const SensedReport sensed = VirtualRemote(ideal(settings.leds), 1, "r").sense(0, s);
        const std::unique_ptr<Tracker> tracker = make_tracker("three-led", settings);
        const Report& report = tracker->update(0, sensed.channels);
        ASSERT_TRUE(report.valid);
        const Vector3d turn = vector_from_rotation(report.pose.rotation * sensed.X_LH.rotation.conjugate());
        EXPECT_LE(turn.norm(), 0.5 * kDegree);
        EXPECT_LE((report.pose.position - sensed.X_LH.position).norm(), 0.002);
      }
}

TEST(ThreeLed, RefusesTwoLeds) {
  EXPECT_THROW((void)make_tracker("three-led", {}), Error);
}

TEST(Stereo, SeesYawWithTwoLeds) {
  const ValidationRow row = row_of("stereo", "natural-yaw");
  EXPECT_LE(row.position.rms, 0.008);
  EXPECT_LE(row.orientation.rms_axis.y(), 2);
}

TEST(Stereo, GoesOnWithEitherRemoteAlone) {
  TrackerSettings settings;
  const Pose X_R1R2 = {{0.5, 0, 0}, rotation_from_vector({0, -0.4, 0})};
  settings.X_R1R2 = X_R1R2;
  Situation first;
  first.X_WH = {{0, 0, 1.2}, Quaterniond::Identity()};
  Situation second = first;
  second.X_WR = X_R1R2;
  const Channels c1 = VirtualRemote({}, 1, "a").sense(0, first).channels;
  const Channels c2 = VirtualRemote({}, 1, "b").sense(0, second).channels;
  const std::unique_ptr<Tracker> tracker = make_tracker("stereo", settings);
  double t = 0;
  for (; t < 0.5; t += 0.01) {
    (void)tracker->update(t, c2, 1);
    EXPECT_TRUE(tracker->update(t, c1, 0).valid);
  }
  for (; t < 1; t += 0.01) EXPECT_TRUE(tracker->update(t, c1, 0).valid) << t;
  const double silent_since = t - 0.01;
  for (; t < 1.5; t += 0.01) {
    const Report& report = tracker->update(t, c2, 1);
    if (t - silent_since > 0.06) {
      EXPECT_TRUE(report.news && report.valid) << t;
    }
    EXPECT_LT((report.pose.position - first.X_WH.position).norm(), 0.03);
  }
}

// A lamp in both images is no head: not while the LEDs are dark, and not instead of them afterwards.
TEST(Stereo, DoesNotFollowALamp) {
  const ValidationRow row = row_of("stereo", "dropout-both", "lamp");
  EXPECT_EQ(row.false_validity, 0);
  EXPECT_LE(row.position.max, 0.05);
}

// The lamp comes in the very moment in which an LED goes dark, and is taken for it. Once all three lights are in view
// the right pair is found again.
TEST(TwoLeds, ComeBackFromALampThatTookAnLedsPlace) {
  for (const char* tracker : {"geometric", "scaat"}) {
    SCOPED_TRACE(tracker);
    const ValidationRow row = row_of(tracker, "dropout-one", "lamp");
    EXPECT_LE(row.position.p95, 0.03);
    EXPECT_GE(row.within_95, 0.95);
    EXPECT_GE(row.availability, 0.99);
  }
}

}  // namespace
}  // namespace verisim::wii::multi_point_test
