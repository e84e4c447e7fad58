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

TEST(Bootstrap, GivesTheSameDigitsEveryTime) {
  const std::vector<double> values = {1, 2, 4, 8, 16};
  const Interval first = bootstrap_of_mean(values, 3, "depth"), second = bootstrap_of_mean(values, 3, "depth");
  EXPECT_EQ(first.low, second.low);
  EXPECT_EQ(first.high, second.high);
  const Interval other = bootstrap_of_mean(values, 4, "depth");
  EXPECT_TRUE(first.low != other.low || first.high != other.high);
}

TEST(Bootstrap, OfEqualValuesIsThatValue) {
  EXPECT_EQ(bootstrap_of_mean({7}, 1, "a").low, 7);
  EXPECT_EQ(bootstrap_of_mean({7, 7, 7}, 1, "a").high, 7);
}

// Of 400 normal values the mean's interval is 1.96 / sqrt(400) = 0.098 to each side, known to about 5 %; of 200 such
// samples it holds the true mean in 95 %, that is 190 give or take 3 (three sigma: 9).
TEST(Bootstrap, HoldsTheMeanAsOftenAsItSays) {
  int held = 0;
  double half = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const RandomStream stream(seed, "test");
    std::vector<double> values;
    for (std::uint64_t i = 0; i < 400; ++i) values.push_back(stream.normal(i));
    const Interval interval = bootstrap_of_mean(values, seed, "x");
    held += interval.low <= 0 && 0 <= interval.high ? 1 : 0;
    half += (interval.high - interval.low) / 2 / 200;
  }
  EXPECT_NEAR(half, 1.96 / 20, 0.005);
  EXPECT_NEAR(held, 190, 9);
}

TEST(IntervalsContracts, NothingHasNoInterval) {
  EXPECT_BROKEN(wilson(0, 0), "all > 0");
  EXPECT_BROKEN(wilson(2, 1), "count <= all");
  EXPECT_BROKEN(mean_of({}), "!values.empty()");
  EXPECT_BROKEN(bootstrap_of_mean({}, 1, "x"), "!values.empty()");
}

}  // namespace
}  // namespace verisim::batch::intervals_test
