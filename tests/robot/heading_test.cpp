// The base's heading: it returns to what is wanted, and stays out of the line of sight.
#include "engine/robot/heading.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/pinned_math.hpp"
#include "tests/support/random_inputs.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::robot::heading_test {
namespace {

constexpr double kDegree = pinned::kPi / 180;

TrackedBase at(double theta, double age = 0, bool is_new = true) {
  return {.pose = {0, 0, theta}, .age = age, .is_valid = true, .is_new = is_new};
}

TEST(Wrapped, IsTheSameAngleWithinHalfATurn) {
  EXPECT_EQ(wrapped(0), 0);
  EXPECT_NEAR(wrapped(3 * pinned::kPi), pinned::kPi, test::tolerance(1e-14));
  EXPECT_EQ(wrapped(-pinned::kPi), pinned::kPi);
  for (const std::uint64_t seed : test::seeds(500)) {
    const double angle = test::Inputs(seed).between(-100, 100), w = wrapped(angle);
    EXPECT_GT(w, -pinned::kPi - 1e-14);
    EXPECT_LE(w, pinned::kPi + 1e-14);
    EXPECT_NEAR(std::cos(w), std::cos(angle), test::tolerance(1e-13));
    EXPECT_NEAR(std::sin(w), std::sin(angle), test::tolerance(1e-13));
  }
}

// A base that turns as it is told, seen every millisecond: theta falls by the factor 1 - p dt a step.
TEST(Heading, ErrorFallsExponentially) {
  Heading heading({.p = 2}, 0);
  double theta = 0.2;
  for (int ms = 0; ms < 1000; ++ms) theta += heading.advance(at(theta), {}) * 0.001;
  EXPECT_NEAR(theta, 0.2 * std::pow(1 - 0.002, 1000), test::tolerance(1e-12));
}

TEST(Heading, TurnsTheShortWayAndNoFasterThanItsLimit) {
  Heading heading({}, 0);
  EXPECT_EQ(heading.advance(at(3.0), {}), -0.5);
  EXPECT_EQ(heading.advance(at(-3.0), {}), 0.5);
  EXPECT_EQ(heading.advance(at(pinned::kFullTurn + 3.3), {}), 0.5) << "3.3 rad to the left are 2.98 to the right";
  EXPECT_NEAR(heading.advance(at(-0.1), {}), 0.2, test::tolerance(1e-15));
}

// A torque that turns the base by 0.05 rad/s however it is driven: P alone stands off by 0.05 / p, the integral by
// nothing.
TEST(Heading, IntegralTakesAwayWhatATorqueLeaves) {
  for (const double i : {0.0, 1.0}) {
    Heading heading({.p = 2, .i = i}, 0);
    double theta = 0;
    for (int ms = 0; ms < 20'000; ++ms) theta += (heading.advance(at(theta), {}) + 0.05) * 0.001;
    EXPECT_NEAR(theta, i == 0 ? 0.025 : 0, 1e-6);
  }
}

// Held at its limit for 10 s the integral does not grow: what follows overshoots by less than a degree.
TEST(Heading, IntegralDoesNotWindUp) {
  Heading heading({.p = 2, .i = 1}, 0);
  double theta = 1;
  for (int ms = 0; ms < 10'000; ++ms) (void)heading.advance(at(theta), {});
  double least = theta;
  for (int ms = 0; ms < 10'000; ++ms) {
    theta += heading.advance(at(theta), {}) * 0.001;
    least = std::fmin(least, theta);
  }
  EXPECT_GT(least, -2 * kDegree);
}

// With the tracker gone the command holds for 0.25 s, 0.5 of the error at p = 2, and is 0 from then on.
TEST(Heading, HoldsWhileTheTrackerIsGoneAndThenTurnsNothing) {
  Heading heading({}, 0);
  double theta = 0.1;
  theta += heading.advance(at(theta), {}) * 0.001;
  for (int ms = 1; ms < 2000; ++ms) {
    theta += heading.advance(at(0.1, ms * 0.001, false), {}) * 0.001;
    EXPECT_EQ(heading.is_on(), ms < 250);
  }
  EXPECT_NEAR(theta, 0.1 - 0.25 * 0.2, test::tolerance(1e-12));
}

// 60 Hz, 20 ms late, a motor lag of 80 ms, and a slip of 5 degrees at once: within 2 degrees in 1 s.
TEST(Heading, SlipIsTurnedBackThroughARealTracker) {
  BaseTracker tracker({}, 1, "art");
  Heading heading({}, 0);
  double theta = 0, omega = 0;
  for (int ms = 0; ms < 5000; ++ms) {
    if (ms == 1000) theta += 5 * kDegree;
    omega += (heading.advance(tracker.advance({0, 0, theta}), {}) - omega) * 0.001 / 0.08;
    theta += omega * 0.001;
    if (ms > 2000 || (ms > 200 && ms < 1000)) {
      ASSERT_LT(std::abs(theta), 2 * kDegree) << ms;
    }
  }
}

// The neutral point stands ahead, the person looks along x: straight ahead is in the line, 60 degrees to a side is not.
TEST(ClearOfSight, TurnsToTheNearestHeadingThatIsClear) {
  const double c = 60 * kDegree;
  const auto turned = [c](double now) { return heading_clear_of_sight(now * kDegree, 0, 0, c) / kDegree; };
  EXPECT_NEAR(turned(0), 60, 1e-12);
  EXPECT_NEAR(turned(10), 60, 1e-12);
  EXPECT_NEAR(turned(-10), -60, 1e-12);
  EXPECT_NEAR(turned(90), 90, 1e-12);
  EXPECT_NEAR(turned(170), 120, 1e-12) << "beyond the handle, facing the person";
  EXPECT_NEAR(turned(-170), -120, 1e-12);
  EXPECT_NEAR(std::abs(wrapped(turned(180) * kDegree)), 120 * kDegree, 1e-12);
}

TEST(ClearOfSight, IsClearAndNoFurtherThanItMustFromAnywhere) {
  for (const std::uint64_t seed : test::seeds(500)) {
    test::Inputs inputs(seed);
    const double now = inputs.between(-10, 10), sight = inputs.between(-10, 10), neutral = inputs.between(-4, 4);
    const double clearance = inputs.between(0, pinned::kPi / 2);
    const double to = heading_clear_of_sight(now, sight, neutral, clearance);
    EXPECT_GE(std::abs(std::sin(to + neutral - sight)), std::sin(clearance) - 1e-12) << seed;
    EXPECT_LE(std::abs(to - now), clearance + 1e-12) << seed;
    EXPECT_NEAR(heading_clear_of_sight(to, sight, neutral, clearance), to, 1e-12) << seed << ": stays there";
  }
}

TEST(Heading, FollowsTheLineOfSightIfAsked) {
  Heading heading({.clearance = 60 * kDegree}, 0);
  double theta = 0.1;
  for (int ms = 0; ms < 10'000; ++ms) theta += heading.advance(at(theta), 0.0) * 0.001;
  EXPECT_NEAR(theta, 60 * kDegree, 1e-6);
  for (int ms = 0; ms < 1000; ++ms) theta += heading.advance(at(theta), {}) * 0.001;
  EXPECT_NEAR(theta, 60 * kDegree, 1e-6) << "without a head it stays";
}

TEST(Heading, RefusesSettingsOutOfRange) {
  test::expect_refused([] { return Heading({.p = -1}, 0).desired(); }, "heading: p is -1");
  test::expect_refused([] { return Heading({.omega_max = 0}, 0).desired(); }, "omega_max is 0");
  test::expect_refused([] { return Heading({.clearance = 2}, 0).desired(); }, "clearance is 2");
  test::expect_refused([] { return Heading({.p = 5}, 0).desired(); }, "p x lost_after is 1.25");
}

}  // namespace
}  // namespace verisim::robot::heading_test
