#include "engine/batch/intervals.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/random.hpp"
#include "tests/support/broken.hpp"

namespace verisim::batch::intervals_test {
namespace {

// Newcombe (1998), Statistics in Medicine 17, table I, method 3 (score): four places.
TEST(Wilson, GivesThePublishedValues) {
  const struct {
    std::uint64_t count, all;
    double low, high;
  } worked[] = {{81, 263, 0.2553, 0.3662}, {15, 148, 0.0624, 0.1605}, {0, 20, 0.0000, 0.1611}, {1, 29, 0.0061, 0.1718}};
  for (const auto& w : worked) {
    EXPECT_NEAR(wilson(w.count, w.all).low, w.low, 0.5e-4) << w.count << " of " << w.all;
    EXPECT_NEAR(wilson(w.count, w.all).high, w.high, 0.5e-4) << w.count << " of " << w.all;
  }
}

TEST(Wilson, IsMirroredAndHoldsTheShare) {
  for (std::uint64_t all = 1; all < 60; ++all)
    for (std::uint64_t count = 0; count <= all; ++count) {
      const Interval i = wilson(count, all), mirrored = wilson(all - count, all);
      const double share = static_cast<double>(count) / static_cast<double>(all);
      EXPECT_NEAR(i.low, 1 - mirrored.high, 1e-15);
      EXPECT_GE(i.low, 0);
      EXPECT_LE(i.high, 1);
      EXPECT_LE(i.low, share);
      EXPECT_GE(i.high, share);
    }
}

TEST(IntervalOfMean, GivesTheSameDigitsEveryTime) {
  const std::vector<double> values = {1, 2, 4, 8, 16, 32};
  const Interval first = interval_of_mean(values, 3, "depth").value(),
                 second = interval_of_mean(values, 3, "depth").value();
  EXPECT_EQ(first.low, second.low);
  EXPECT_EQ(first.high, second.high);
  const Interval other = interval_of_mean(values, 4, "depth").value();
  EXPECT_TRUE(first.low != other.low || first.high != other.high);
}

TEST(IntervalOfMean, OfEqualValuesIsThatValueAndOfOneThereIsNone) {
  EXPECT_EQ(interval_of_mean({7, 7, 7}, 1, "a")->high, 7);
  EXPECT_FALSE(interval_of_mean({7}, 1, "a"));
}

TEST(IntervalOfMean, OfFewIsStudents) {
  constexpr double kT = 2.776445;  // of four degrees of freedom, 97.5 %: every table
  const Interval interval = interval_of_mean({1, 2, 3, 4, 5}, 1, "a").value();
  EXPECT_NEAR(interval.low, 3 - kT * std::sqrt(2.5 / 5), 1e-6);
  EXPECT_NEAR(interval.high, 3 + kT * std::sqrt(2.5 / 5), 1e-6);
}

// Of 400 normal values the mean's interval is 1.96 / sqrt(400) = 0.098 to each side, known to about 5 %.
TEST(IntervalOfMean, OfManyIsThatOfTheNormalDistribution) {
  double half = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const RandomStream stream(seed, "test");
    std::vector<double> values;
    for (std::uint64_t i = 0; i < 400; ++i) values.push_back(stream.normal(i));
    const Interval interval = interval_of_mean(values, seed, "x").value();
    half += (interval.high - interval.low) / 2 / 200;
  }
  EXPECT_NEAR(half, 1.96 / 20, 0.005);
}

// Of 600 samples 95 % are 570, give or take 5 (three sigma: 16). Plain percentiles of resamples hold the mean of 2, 5,
// 10 and 20 values in 50, 84, 90 and 92 %.
TEST(IntervalOfMean, HoldsTheMeanAsOftenAsItSaysOfHoweverFew) {
  for (const std::uint64_t n : {2, 3, 5, 6, 7, 10, 20}) {
    int held = 0;
    for (std::uint64_t seed = 0; seed < 600; ++seed) {
      const RandomStream stream(seed, "test");
      std::vector<double> values;
      for (std::uint64_t i = 0; i < n; ++i) values.push_back(stream.normal(i));
      const Interval interval = interval_of_mean(values, seed, "x").value();
      held += interval.low <= 0 && 0 <= interval.high ? 1 : 0;
    }
    EXPECT_NEAR(held, 570, 16) << n;
  }
}

TEST(IntervalsContracts, NothingHasNoInterval) {
  EXPECT_BROKEN(wilson(0, 0), "all > 0");
  EXPECT_BROKEN(wilson(2, 1), "count <= all");
  EXPECT_BROKEN(mean_of({}), "!values.empty()");
  EXPECT_BROKEN(interval_of_mean({}, 1, "x"), "!values.empty()");
}

}  // namespace
}  // namespace verisim::batch::intervals_test
