#include "engine/compare/shift.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine/base/random.hpp"
#include "tests/length.hpp"
#include "tests/support/broken.hpp"

namespace verisim::compare::shift_test {
namespace {

using Values = std::vector<double>;

// Hollander and Wolfe, examples 3.3 and 3.4 (depression scale): estimate -0.46, 96.1 % interval (-0.786, -0.010).
TEST(ShiftOfPairs, IsThePublishedExample) {
  const Values x = {1.83, 0.50, 1.62, 2.48, 1.68, 1.88, 1.55, 3.06, 1.30};
  const Values y = {0.878, 0.647, 0.598, 2.05, 1.06, 1.29, 1.06, 3.14, 1.29};
  Values d;
  for (std::size_t i = 0; i < x.size(); ++i) d.push_back(y[i] - x[i]);
  const Shift shift = shift_of_pairs(d, 0.95);
  EXPECT_NEAR(shift.estimate, -0.46, 1e-12);
  EXPECT_NEAR(shift.low, -0.786, 1e-12);
  EXPECT_NEAR(shift.high, -0.010, 1e-12);
}

// By hand: of 4 x 4 samples the 95 % interval goes from the first to the last difference: P(U <= 0) = 1/70 = 0.0143 is
// below 0.025, P(U <= 1) = 2/70 is not.
TEST(ShiftOfSamples, IsTheWorkedExample) {
  const Values a = {1, 2, 3, 4}, b = {11, 12, 13, 24};
  const Shift shift = shift_of_samples(a, b, 0.95);
  EXPECT_EQ(shift.estimate, 10);  // the middle of 7 8 8 9 9 9 10 10 10 11 11 12 20 21 22 23
  EXPECT_EQ(shift.low, 7);
  EXPECT_EQ(shift.high, 23);
}

TEST(Shift, OfTooFewIsNotBounded) {
  const Shift samples = shift_of_samples(Values{1, 2, 3}, Values{2, 3, 4}, 0.95);  // P(U <= 0) = 1/20
  EXPECT_EQ(samples.estimate, 1);
  EXPECT_TRUE(std::isinf(samples.low) && samples.low < 0);
  EXPECT_TRUE(std::isinf(samples.high) && samples.high > 0);
  EXPECT_TRUE(std::isinf(shift_of_pairs(Values{1, 2, 3, 4, 5}, 0.95).high));  // 2^-5 is above 0.025
  EXPECT_FALSE(std::isinf(shift_of_pairs(Values{1, 2, 3, 4, 5, 6}, 0.95).high));
}

TEST(Shift, MovesWithWhatIsAddedAndNotWithOneWildValue) {
  Values a, b;
  const RandomStream random(3, "shift_test");
  for (std::uint64_t i = 0; i < 30; ++i) {
    a.push_back(random.normal(2 * i));
    b.push_back(random.normal(2 * i + 1));
  }
  const Shift before = shift_of_samples(a, b, 0.95);
  for (double& value : b) value += 5;
  EXPECT_NEAR(shift_of_samples(a, b, 0.95).estimate, before.estimate + 5, 1e-12);
  b[7] = 1e9;
  EXPECT_NEAR(shift_of_samples(a, b, 0.95).estimate, before.estimate + 5, 0.3);
}

// Of 95 % intervals 95 % hold the truth, whatever the distribution: exact ones at least so many, and not all.
TEST(Shift, IntervalsCoverTheTruth) {
  const RandomStream random(1, "shift_test.cover");
  std::uint64_t counter = 0;
  for (const std::size_t n : {10U, 40U, 60U}) {
    int pairs = 0, samples = 0;
    const int cases = test::by_length(100, 1000, 10'000);
    for (int i = 0; i < cases; ++i) {
      Values a, b, d;
      for (std::size_t k = 0; k < n; ++k) {
        const double noise = random.normal(counter++), wild = random.normal(counter++);
        a.push_back(noise * noise);  // a long tail
        b.push_back(wild * wild + 1);
        d.push_back(noise * std::abs(noise) + 1);
      }
      const Shift of_pairs = shift_of_pairs(d, 0.95), of_samples = shift_of_samples(a, b, 0.95);
      pairs += of_pairs.low <= 1 && 1 <= of_pairs.high ? 1 : 0;
      samples += of_samples.low <= 1 && 1 <= of_samples.high ? 1 : 0;
    }
    // Discreteness widens intervals of 10, to 0.96.
    const double four_standard_errors = 4 * std::sqrt(0.95 * 0.05 / cases);
    EXPECT_NEAR(pairs / double(cases), 0.955, four_standard_errors) << n;
    EXPECT_NEAR(samples / double(cases), 0.955, four_standard_errors) << n;
  }
}

TEST(Median, IsTheMeanOfTheTwoInTheMiddle) {
  EXPECT_EQ(median_of(Values{3, 1, 2}), 2);
  EXPECT_EQ(median_of(Values{4, 1, 2, 10}), 3);
}

TEST(ShiftDeathTest, NeedsValues) {
  EXPECT_BROKEN(shift_of_pairs({}, 0.95), "!differences.empty()");
  EXPECT_BROKEN(shift_of_samples(Values{1}, {}, 0.95), "!b.empty()");
  EXPECT_BROKEN(shift_of_samples(Values{1}, Values{1}, 1), "level < 1");
  EXPECT_BROKEN(median_of({}), "!values.empty()");
}

}  // namespace
}  // namespace verisim::compare::shift_test
