// The estimator of motor velocity, against rates that are known. Units: RPM/16 of velocities, ticks of 4 us.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "engine/base/random.hpp"
#include "firmware_sim/firmware/velocity.hpp"

namespace verisim::firmware {
namespace velocity_test {

constexpr double kTicksPerS = 250'000, kSampleTicks = kSampleMs * double{kTicksPerMs};
constexpr double kEdgesPerTurn = 48;

double interval_ticks(double rpm) {
  return kTicksPerS * 60 / kEdgesPerTurn / std::abs(rpm);
}

/// An encoder that is turned, and the estimator behind it, sample by sample.
struct Turned {
  Encoder encoder;
  VelocityEstimator estimator;
  double next_edge = 1, sample = 0;
  std::int64_t position = 0;

  void edge(int direction, double tick) {
    constexpr std::uint8_t kGray[] = {0, 1, 3, 2};
    position += direction;
    const auto at = static_cast<std::uint64_t>(tick);
    encoder.edge(kGray[position & 3], static_cast<std::uint16_t>(at / kTicksPerMs),
                 static_cast<std::uint8_t>(at % kTicksPerMs));
  }

  /// One sample, with edges `interval` ticks apart in this direction; `jitter` moves each by so much of an interval.
  std::int32_t step(
      int direction, double interval, const std::function<double()>& jitter = [] { return 0.0; }) {
    const double end = (sample + 1) * kSampleTicks;
    for (double at = next_edge + interval * jitter(); at < end; at = next_edge + interval * jitter()) {
      edge(direction, std::max(at, sample * kSampleTicks));
      next_edge += interval;
    }
    ++sample;
    return estimator.update(encoder, static_cast<std::uint16_t>(static_cast<std::uint64_t>(sample) * kSampleMs));
  }
};

// The time between two edges is known to one tick; it is at least the longer of an interval and a sample less one.
TEST(Velocity, OfAConstantRateIsExactToATickFromOneRpmTo7000) {
  for (const int direction : {1, -1}) {
    for (double rpm = 1; rpm <= 7000; rpm *= 1.13) {
      Turned turned;
      const double interval = interval_ticks(rpm);
      const double time = std::max(interval, kSampleTicks - interval);
      const double bound = 16 * rpm / (time - 1) + 1;  // and the result is cut to 1/16 RPM
      for (int sample = 0; sample < 1000; ++sample) {
        const std::int32_t v = turned.step(direction, interval);
        if (turned.position * direction >= 3) {
          ASSERT_NEAR(v, direction * rpm * 16, bound) << rpm << " RPM, sample " << sample;
        }
      }
      ASSERT_GE(turned.position * direction, 3);
    }
  }
}

TEST(Velocity, OfOneRpmIsExact) {
  Turned turned;
  for (int sample = 0; sample < 1000; ++sample) turned.step(1, interval_ticks(1));
  EXPECT_EQ(turned.step(1, interval_ticks(1)), 16);
}

// Each of the two edges that end a sample's time is off by at most 0.2 intervals.
TEST(Velocity, OfAJitteredRateIsOffByNoMoreThanItsTwoEdges) {
  for (double rpm = 20; rpm <= 7000; rpm *= 1.7) {
    Turned turned;
    RandomStream random(7, "velocity_test");
    std::uint64_t drawn = 0;
    const double interval = interval_ticks(rpm);
    const double time = std::max(0.6 * interval, kSampleTicks - 1.4 * interval);
    for (int sample = 0; sample < 400; ++sample) {
      const std::int32_t v = turned.step(1, interval, [&] { return 0.4 * random.uniform(drawn++) - 0.2; });
      if (turned.position >= 3) {
        ASSERT_NEAR(v, rpm * 16, rpm * 16 * (0.4 * interval + 1) / (time - 1) + 1) << rpm;
      }
    }
  }
}

TEST(Velocity, FallsWithTheTimeSinceTheLastEdgeAndIsZeroAfterThreeSeconds) {
  Turned turned;
  for (int sample = 0; sample < 50; ++sample) turned.step(-1, interval_ticks(3000));
  const double stopped = turned.sample;
  std::int32_t last = -3000 * 16;
  for (int sample = 0; sample < 620; ++sample) {
    turned.next_edge = (turned.sample + 2) * kSampleTicks;  // none comes
    const std::int32_t v = turned.step(-1, 1);
    ASSERT_GE(v, last) << "it never rises while nothing turns";
    ASSERT_LE(v, 0);
    const double age_s = (turned.sample - stopped) * kSampleMs * 1e-3;
    ASSERT_GE(v, -60 / 48.0 / age_s * 16 - 1) << "one count in the time since the last edge";
    last = v;
  }
  EXPECT_EQ(last, 0);
}

TEST(Velocity, NeverReachesBeyondTheTrueOneInAReversal) {
  Turned turned;
  for (int sample = 0; sample < 20; ++sample) turned.step(1, interval_ticks(2000));
  for (int sample = 0; sample < 20; ++sample) {
    const std::int32_t v = turned.step(-1, interval_ticks(2000));
    EXPECT_LE(std::abs(v), 2000 * 16 * 1.02);
    if (sample > 0) {
      EXPECT_LT(v, 0);
    }
  }
}

TEST(Velocity, AfterAPauseIsNearInTheFirstSampleAndNeverTooHigh) {
  for (const double rpm : {500.0, 2000.0, 7000.0}) {
    Turned turned;
    turned.next_edge = 60'000 * 250.0 + 300;  // a minute: longer than anything remembers
    while (turned.sample * kSampleTicks < turned.next_edge - kSampleTicks) turned.step(1, interval_ticks(rpm));
    const std::int32_t first = turned.step(1, interval_ticks(rpm));
    EXPECT_LE(first, rpm * 16);
    EXPECT_GE(first, rpm * 16 * (1 - 300 / kSampleTicks - 2 * interval_ticks(rpm) / kSampleTicks));
    EXPECT_NEAR(turned.step(1, interval_ticks(rpm)), rpm * 16, rpm * 16 / 1000 + 1);
  }
}

TEST(Velocity, CountsNothingWhereBothLevelsChange) {
  Encoder encoder;
  encoder.edge(3, 0, 0);
  EXPECT_EQ(encoder.count, 0);
  EXPECT_EQ(encoder.illegal, 1);
  encoder.edge(2, 0, 1);  // goes on from what it saw
  EXPECT_EQ(encoder.count, 1);
}

}  // namespace velocity_test
}  // namespace verisim::firmware
