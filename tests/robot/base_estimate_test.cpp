// Where the base is now, of late and rare reports.
#include "engine/robot/base_estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/random.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::robot::base_estimate_test {
namespace {

using test::tolerance;

constexpr double kStep = 1e-3, kLatency = 0.02, kRate = 60;  // s, s, Hz

/// Runs an estimate over a motion x(t) for 4 s; calls look(t, place) every ms from 1 s on.
template <typename Motion, typename Look>
void follow(BaseEstimate& estimate, const Motion& motion, double noise, const Look& look) {
  const RandomStream random(3, "noise");
  int reports = 0;
  for (int ms = 1; ms <= 4000; ++ms) {
    const double t = ms * kStep;
    if ((reports + 1) / kRate + kLatency <= t + 1e-9) {
      const double taken = ++reports / kRate;
      const double error = noise * random.normal(static_cast<std::uint64_t>(reports));
      estimate.hear({motion(taken) + error, -motion(taken), 0.5 * motion(taken)}, taken);
    }
    estimate.advance(t);
    if (ms > 1000) look(t, estimate.place());
  }
}

// The filter's fixed point is the straight line itself; what is left of the start has decayed by (1 - alpha)^(n/2).
TEST(BaseEstimate, OfABaseThatRollsEvenlyIsWhereItIs) {
  BaseEstimate estimate({0, 0, 0}, {});
  const auto even = [](double t) { return 1 + 0.45 * t; };
  follow(estimate, even, 0, [&](double t, const BaseEstimate::Place& place) {
    ASSERT_NEAR(place[0], even(t), tolerance(1e-9)) << t;
    ASSERT_NEAR(place[1], -even(t), tolerance(1e-9)) << t;
    ASSERT_NEAR(place[2], 0.5 * even(t), tolerance(1e-9)) << t;
  });
}

// A base that turns back within a second (peaks of 0.94 m/s and 2 m/s^2). Reports alone: 37 ms of way, 34 mm.
TEST(BaseEstimate, IsNearABaseThatTurnsBackAndNeverJumps) {
  BaseEstimate estimate({0, 0, 0}, {});
  const auto walk = [](double t) { return 0.45 * std::sin(2.1 * t); };
  double worst = 0, jump = 0, before = NAN;
  follow(estimate, walk, 0.0003, [&](double t, const BaseEstimate::Place& place) {
    worst = std::max(worst, std::abs(place[0] - walk(t)));
    if (std::isfinite(before)) jump = std::max(jump, std::abs(place[0] - before));
    before = place[0];
  });
  EXPECT_LT(worst, 0.007);  // a T^2 (1 - alpha) / beta + (a T (alpha / beta - 1 / 2)) 37 ms + a (37 ms)^2 / 2 is 4.5;
                            // noise and smoothing
  EXPECT_LT(jump, 0.0015);  // 1 ms at 0.94 m/s, and the correction of a report spread over 20
}

TEST(BaseEstimate, TakesReportsAsTheyAreIfItIsTold) {
  BaseEstimate estimate({0, 0, 0}, {.alpha = 1, .horizon = 0, .smoothing = 0});
  estimate.hear({1, 2, 3}, 0.1);
  estimate.advance(0.13);
  EXPECT_EQ(estimate.place(), (BaseEstimate::Place{1, 2, 3}));
  estimate.hear({1.1, 2, 3}, 0.12);
  estimate.advance(0.131);
  EXPECT_EQ(estimate.place(), (BaseEstimate::Place{1.1, 2, 3}));
}

// A tracker that is gone: on for the horizon, then it stands.
TEST(BaseEstimate, StandsStillWithoutReports) {
  BaseEstimate estimate({0, 0, 0}, {});
  follow(
      estimate, [](double t) { return t; }, 0, [](double, const BaseEstimate::Place&) {});
  const double last = std::floor((4 - kLatency) * kRate + 1e-9) / kRate;
  for (int ms = 4001; ms < 7000; ++ms) estimate.advance(ms * kStep);
  EXPECT_NEAR(estimate.place()[0], last + EstimateParameters{}.horizon, 1e-6);
  estimate.hear({2, 0, 0}, 6.9);  // found again: slides there
  for (int ms = 7000; ms < 7200; ++ms) estimate.advance(ms * kStep);
  EXPECT_NEAR(estimate.place()[0], 2, 0.001);  // ten times the smoothing's time later, exp(-10) of 2 m
}

}  // namespace
}  // namespace verisim::robot::base_estimate_test
