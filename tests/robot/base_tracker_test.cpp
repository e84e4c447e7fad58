// The tracker of the base: when reports come, how old they are, how they err, and when there are none.
#include "engine/robot/base_tracker.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/refusal.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::robot::base_tracker_test {
namespace {

BaseTrackerSettings exact() {
  BaseTrackerSettings settings;
  settings.sigma_position = settings.sigma_yaw = 0;
  return settings;
}

// 60 Hz for 10 s: samples at 0, 1/60, ..., 599/60 s. Those of the last 20 ms, two of them, are still under way.
TEST(BaseTracker, ReportsSixtyTimesASecond) {
  BaseTracker tracker(exact(), 1, "art");
  int reports = 0;
  for (int ms = 0; ms < 10'000; ++ms) reports += tracker.advance({}).is_new ? 1 : 0;
  EXPECT_EQ(tracker.samples(), 600U);
  EXPECT_EQ(reports, 599);
}

// x is the millisecond of the sample, so that x plus age must be the present one, whatever latency and rate.
TEST(BaseTracker, AgeIsTheTimeSinceTheSample) {
  for (const double rate : {1000.0, 60.0, 33.3}) {
    BaseTrackerSettings settings = exact();
    settings.rate = rate;
    BaseTracker tracker(settings, 1, "art");
    double oldest = 0;
    for (int ms = 0; ms < 5000; ++ms) {
      const TrackedBase& tracked = tracker.advance({ms * 0.001, 0, 0});
      if (ms < 20) {
        ASSERT_TRUE(std::isinf(tracked.age));
        ASSERT_FALSE(tracked.is_valid);
        continue;
      }
      ASSERT_NEAR(tracked.pose.x + tracked.age, ms * 0.001, test::tolerance(1e-12));
      ASSERT_GE(tracked.age, 0.020);
      oldest = std::fmax(oldest, tracked.age);
    }
    EXPECT_NEAR(oldest, 0.020 + 1 / rate - 0.0005, 0.0005 + 1e-12) << "just before the next report, in whole ms";
  }
}

// 60,000 samples: the standard deviation's own is sigma / sqrt(2 n) = 0.3 %, the mean's sigma / sqrt(n); five of them.
TEST(BaseTracker, NoiseHasTheDeviationThatItIsTold) {
  BaseTrackerSettings settings;
  settings.rate = 1000;
  settings.sigma_position = 0.001;
  settings.sigma_yaw = 0.004;
  BaseTracker tracker(settings, 3, "art");
  double sum[3] = {}, squares[3] = {};
  int n = 0;
  for (int ms = 0; ms < 60'020; ++ms) {
    const TrackedBase& tracked = tracker.advance({1, 2, 3});
    if (!tracked.is_new) continue;
    ++n;
    const double off[3] = {tracked.pose.x - 1, tracked.pose.y - 2, tracked.pose.theta - 3};
    for (int i = 0; i < 3; ++i) {
      sum[i] += off[i];
      squares[i] += off[i] * off[i];
    }
  }
  ASSERT_EQ(n, 60'000);
  for (int i = 0; i < 3; ++i) {
    const double sigma = i < 2 ? 0.001 : 0.004;
    EXPECT_NEAR(sum[i] / n, 0, 5 * sigma / std::sqrt(n));
    EXPECT_NEAR(std::sqrt(squares[i] / n), sigma, 5 * sigma / std::sqrt(2.0 * n));
  }
}

// Begins at 0.5 per second of good time, lasts 0.4 s on average: a cycle is 2 + 0.4 s, 1/6 of all samples are lost.
// In 3000 s there are 1250 cycles; the fraction's deviation is about 1/6 * sqrt(2 / 1250) = 0.7 %, five of them.
TEST(BaseTracker, DropoutsHaveTheRateAndMeanLengthThatItIsTold) {
  BaseTrackerSettings settings = exact();
  settings.dropout_rate = 0.5;
  settings.dropout_mean = 0.4;
  BaseTracker tracker(settings, 5, "art");
  std::uint64_t dropouts = 0, dropped_before = 0;
  bool was_dropped = false;
  for (int ms = 0; ms < 3'000'000; ++ms) {
    const std::uint64_t samples = tracker.samples();
    (void)tracker.advance({});
    if (tracker.samples() == samples) continue;
    const bool is_dropped = tracker.dropped() != dropped_before;
    dropouts += is_dropped && !was_dropped ? 1 : 0;
    was_dropped = is_dropped;
    dropped_before = tracker.dropped();
  }
  const double fraction = static_cast<double>(tracker.dropped()) / static_cast<double>(tracker.samples());
  EXPECT_NEAR(fraction, 1.0 / 6, 5.0 / 6 * 0.04);
  EXPECT_NEAR(static_cast<double>(dropouts), 1250, 5 * std::sqrt(1250));
}

// Gone from 1 s to 3 s, as the issue asks: the last sample is that before 1 s, the first that at 3 s, 20 ms later here.
TEST(BaseTracker, GoneForTwoSecondsAndBack) {
  BaseTrackerSettings settings = exact();
  settings.outages = {{1, 3}};
  BaseTracker tracker(settings, 1, "art");
  RobotNotes notes;
  std::vector<std::pair<int, std::string>> said;
  for (int ms = 0; ms < 4000; ++ms) {
    const TrackedBase& tracked = tracker.advance({ms * 0.001, 0, 0});
    if (ms == 3019) {
      EXPECT_NEAR(tracked.age, 3.019 - 0.983, 1e-12);
    }
    tracker.report(notes);
    for (const RobotNotes::Note& note : notes) said.emplace_back(ms, note.text);
    notes.clear();
  }
  ASSERT_EQ(said.size(), 3U);
  EXPECT_EQ(said[0], (std::pair<int, std::string>(20, "follows the base")));
  EXPECT_EQ(said[1], (std::pair<int, std::string>(983 + 101, "has lost the base")));
  EXPECT_EQ(said[2], (std::pair<int, std::string>(3020, "follows the base")));
}

TEST(BaseTracker, SwappedAxesExchangeXAndY) {
  BaseTracker tracker(exact(), 1, "art");
  tracker.swap_axes(true);
  for (int ms = 0; ms < 100; ++ms) (void)tracker.advance({1, 2, 3});
  EXPECT_EQ(tracker.tracked().pose.x, 2);
  EXPECT_EQ(tracker.tracked().pose.y, 1);
  EXPECT_EQ(tracker.tracked().pose.theta, 3);
}

// A stream's value depends on the number of the sample: what is lost does not change what is not.
TEST(BaseTracker, DropoutsDoNotChangeTheNoiseOfOtherReports) {
  BaseTrackerSettings whole, broken;
  broken.outages = {{0.5, 1}};
  BaseTracker a(whole, 9, "art"), b(broken, 9, "art");
  int equal = 0;
  for (int ms = 0; ms < 2000; ++ms) {
    const TrackedBase ta = a.advance({}), tb = b.advance({});
    if (!ta.is_new || !tb.is_new) continue;
    ASSERT_EQ(ta.pose.x, tb.pose.x);
    ++equal;
  }
  EXPECT_EQ(equal, 119 - 30);
}

TEST(BaseTracker, RefusesWhatNoTrackerHas) {
  const auto made = [](void (*change)(BaseTrackerSettings&)) {
    return [change] {
      BaseTrackerSettings settings;
      change(settings);
      return BaseTracker(settings, 1, "art").samples();
    };
  };
  test::expect_refused(made([](auto& s) { s.rate = 0; }), "tracker 'art': rate is 0 but must be above 0");
  test::expect_refused(made([](auto& s) { s.latency = std::nan(""); }), "latency is nan");
  test::expect_refused(made([](auto& s) { s.sigma_yaw = -1; }), "sigma_yaw is -1");
  test::expect_refused(made([](auto& s) { s.dropout_mean = 0; }), "dropout_mean is 0");
  test::expect_refused(made([](auto& s) { s.lost_after = 0.03; }), "lost_after is 0.03");
  test::expect_refused(made([](auto& s) { s.outages = {{2, 1}}; }), "the end of an outage is 1");
}

}  // namespace
}  // namespace verisim::robot::base_tracker_test
