// A head beside a loop: when its reports are taken, and what it says between them.
#include "engine/wii/head.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/error.hpp"

namespace verisim::wii::head_test {
namespace {

constexpr Channels kAhead = {0.75, 0, 0, 1, 609, 384, 4, 415, 384, 4, -1, -1, -1, -1, -1, -1};

Head recorded(const std::vector<double>& times) {
  Recording recording;
  recording.t = times;
  recording.channels.assign(times.size(), kAhead);
  return {"head", make_recorded_source(std::move(recording)), "geometric", {{0, 0, 5}, Quaterniond::Identity()}};
}

// 194 pixels between LEDs 0.15 m apart: 512 / tan(21.5 deg) * 0.15 / 194 = 1.0050 m in front of a remote at z = 5.
TEST(Head, SaysWhereTheHeadIsInTheWorld) {
  Head head = recorded({0, 0.01});
  EXPECT_TRUE(std::isnan(head.estimate().pose.position.x()));
  EXPECT_FALSE(head.estimate().valid);
  head.advance(0.001);
  EXPECT_TRUE(head.estimate().valid);
  EXPECT_NEAR(head.world_pose().position.z(), 5 + 1299.83 * 0.15 / 194, 1e-4);
  EXPECT_TRUE(std::isnan(head.sensed().X_LH.position.x())) << "this recording does not know the truth";
}

// k / 100 and n * 0.001 are rounded each in its own way.
TEST(Head, TakesReportKInTheFrameThatEndsAtItsTime) {
  std::vector<double> times;
  for (int k = 0; k < 10'000; ++k) times.push_back(k / 100.0);
  Head head = recorded(times);
  for (int frame = 1; frame < 100'000; ++frame) {
    head.advance(frame * 0.001);
    ASSERT_EQ(head.taken(), frame == 1 || frame % 10 == 0 ? 1U : 0U) << frame;
  }
}

TEST(Head, TakesAllThatIsDueAndCountsIt) {
  Head head = recorded({3, 3.0001, 3.0002, 3.5});  // counted from the first
  head.advance(0.001);
  EXPECT_EQ(head.taken(), 3U);
  EXPECT_NEAR(head.sensed().t, 0.0002, 1e-12);
  head.advance(0.002);
  EXPECT_EQ(head.taken(), 0U);
  EXPECT_NEAR(head.duration(), 0.5, 1e-12);
}

TEST(Head, StopsStandingByWhatHasGrownOld) {
  Head head = recorded({0});
  head.advance(0.001);
  head.advance(0.4);
  EXPECT_TRUE(head.estimate().valid);
  EXPECT_FALSE(head.estimate().news);
  head.advance(0.6);
  EXPECT_FALSE(head.estimate().valid);
}

TEST(Head, OfAVirtualRemoteKnowsTheTruthAndGoesOn) {
  Head head("head", make_virtual_source({.sensor = "ideal"}), "scaat", {});
  double worst = 0;
  for (int frame = 1; frame <= 20'000; ++frame) {
    head.advance(frame * 0.001);
    worst = std::max(worst, (head.estimate().pose.position - head.sensed().X_LH.position).norm());
  }
  EXPECT_TRUE(head.estimate().valid);
  EXPECT_LT(worst, 0.05);
  EXPECT_EQ(head.duration(), 0);
}

TEST(Head, OfTwoNamesSeesTwoNoises) {
  SensedReport a;
  SensedReport b;
  SensedReport c;
  ASSERT_TRUE(make_virtual_source({.name = "a"})->next(a));
  ASSERT_TRUE(make_virtual_source({.name = "b"})->next(b));
  ASSERT_TRUE(make_virtual_source({.name = "a"})->next(c));
  EXPECT_NE(a.channels, b.channels);
  EXPECT_EQ(a.channels, c.channels);
}

TEST(Head, RefusesUnknownNamesAndGlassesThatDoNotFit) {
  EXPECT_THROW((void)make_virtual_source({.trajectory = "natrual"}), Error);
  EXPECT_THROW((void)make_virtual_source({.sensor = "idael"}), Error);
  EXPECT_THROW(Head("head", make_virtual_source({}), "three-led", {}), Error);
}

}  // namespace
}  // namespace verisim::wii::head_test
