// Nearest rank: worked numbers, and the definition itself counted out.
#include "engine/base/quantile.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/random_inputs.hpp"

namespace verisim::quantile_test {
namespace {

template <typename T>
T quantile_of(std::vector<T> values, double p) {
  return quantile(values, p);
}

// The example that the method is taught with: ranks ceil(5 p) = 1, 2, 2, 3, 5.
TEST(Quantile, IsTheValueOfTheNearestRank) {
  const std::vector<int> values = {50, 15, 40, 20, 35};
  EXPECT_EQ(quantile_of(values, 0.05), 15);
  EXPECT_EQ(quantile_of(values, 0.3), 20);
  EXPECT_EQ(quantile_of(values, 0.4), 20);
  EXPECT_EQ(quantile_of(values, 0.5), 35);
  EXPECT_EQ(quantile_of(values, 1), 50);
}

// Of an even number of values the median is the lower of the two in the middle; of 100 the 99th is the 99 % quantile.
TEST(Quantile, NeverLiesBetweenTwoValues) {
  EXPECT_EQ(quantile_of<double>({4, 1, 3, 2}, 0.5), 2);
  std::vector<int> hundred(100);
  for (int i = 0; i < 100; ++i) hundred[static_cast<std::size_t>(i)] = 100 - i;
  EXPECT_EQ(quantile_of(hundred, 0.99), 99);
  EXPECT_EQ(quantile_of(hundred, 0.991), 100);
}

TEST(Quantile, OfZeroAndOneAreTheEnds) {
  EXPECT_EQ(quantile_of<int>({3, 1, 2}, 0), 1);
  EXPECT_EQ(quantile_of<int>({3, 1, 2}, 1), 3);
  EXPECT_EQ(quantile_of<int>({7}, 0.5), 7);
}

// Smallest value of which at least p n values are not above it; equal values included.
TEST(Quantile, IsWhatItsDefinitionCounts) {
  for (const std::uint64_t seed : test::seeds(200)) {
    SCOPED_TRACE(seed);
    test::Inputs in(seed);
    std::vector<int> values(static_cast<std::size_t>(in.between(1, 40)));
    for (int& v : values) v = static_cast<int>(in.between(0, 20));
    const double p = static_cast<double>(static_cast<int>(in.between(0, 65))) / 64;  // p n is exact
    const int q = quantile_of(values, p);
    const auto at_most = [&](int x) {
      return static_cast<double>(std::ranges::count_if(values, [&](int v) { return v <= x; }));
    };
    EXPECT_TRUE(std::ranges::count(values, q) > 0);
    EXPECT_GE(at_most(q), p * static_cast<double>(values.size()));
    for (const int v : values) {
      if (v < q) {
        EXPECT_LT(at_most(v), p * static_cast<double>(values.size()));
      }
    }
  }
}

TEST(QuantileDeathTest, OfNothingIsABrokenPromise) {
  std::vector<double> none;
  EXPECT_DEATH(static_cast<void>(quantile(none, 0.5)), "empty");
  std::vector<double> one = {1};
  EXPECT_DEATH(static_cast<void>(quantile(one, 1.1)), "p <= 1");
  std::vector<double> nothing = {1, std::nan("")};
  EXPECT_DEATH(static_cast<void>(quantile(nothing, 0.5)), "std::isnan");
}

}  // namespace
}  // namespace verisim::quantile_test
