#include "engine/base/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine/base/random.hpp"
#include "tests/support/broken.hpp"

namespace verisim::statistics_test {
namespace {

TEST(Statistics, MeanAndIntervalOfAWorkedExample) {
  // Mean 5, sample deviation sqrt(20/3); t(0.975, 3) = 3.18245.
  const std::vector<double> samples = {2, 4, 6, 8};
  const Estimate mean = mean_of(samples);
  const double half = 3.18245 * std::sqrt(20.0 / 3 / 4);
  EXPECT_DOUBLE_EQ(mean.value, 5);
  EXPECT_NEAR(mean.interval.first, 5 - half, 1e-12);
  EXPECT_NEAR(mean.interval.second, 5 + half, 1e-12);
}

TEST(Statistics, IntervalUsesStudentsQuantile) {
  // Tables: t(0.975, 4) = 2.77645, t(0.975, 29) = 2.04523. Samples of deviation 1 around 0.
  for (const auto& [degrees, t] : {std::pair(4, 2.77645), std::pair(29, 2.04523)}) {
    std::vector<double> samples(static_cast<std::size_t>(degrees + 1), 0.0);
    const double n = degrees + 1;
    samples.front() = std::sqrt((n - 1) / 2);
    samples.back() = -samples.front();
    EXPECT_NEAR(mean_of(samples).interval.second, t / std::sqrt(n), 0.003 * t) << degrees;
  }
}

TEST(Statistics, SamplesThatAgreeLeaveNoDoubt) {
  const std::vector<double> same = {0.5, 0.5, 0.5};
  EXPECT_EQ(mean_of(same).interval, std::pair(0.5, 0.5));
  EXPECT_EQ(ratio_of(same, same).interval, std::pair(1.0, 1.0));
}

TEST(Statistics, RatioOfSumsAndNotOfSingleSamples) {
  const std::vector<double> a = {1, 3, 8};
  const std::vector<double> b = {2, 2, 2};
  EXPECT_DOUBLE_EQ(ratio_of(a, b).value, 2);
  const Estimate mean = mean_of(a);  // b is constant, so the ratio's interval is the mean's, divided by it
  EXPECT_NEAR(ratio_of(a, b).interval.first, mean.interval.first / 2, 1e-12);
  EXPECT_FALSE(std::isfinite(ratio_of(a, std::vector<double>{0, 0, 0}).value));
}

TEST(Statistics, IntervalCoversTheTruthInAbout95OfAHundredCases) {
  const RandomStream random(1, "statistics_test");
  std::uint64_t counter = 0;
  int covered = 0;
  constexpr int kCases = 2000;
  for (int i = 0; i < kCases; ++i) {
    std::vector<double> a(8), b(8);
    for (std::size_t k = 0; k < a.size(); ++k) {
      b[k] = 2 + 0.3 * random.normal(counter++);
      a[k] = 1.5 * b[k] + 0.2 * random.normal(counter++);
    }
    const Estimate ratio = ratio_of(a, b);
    covered += ratio.interval.first <= 1.5 && 1.5 <= ratio.interval.second ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(covered) / kCases, 0.95, 0.025);
}

TEST(StatisticsDeathTest, NeedTwoSamplesOrPairs) {
  const std::vector<double> one = {1}, two = {1, 2};
  EXPECT_BROKEN(mean_of(one), "samples.size() >= 2");
  EXPECT_BROKEN(ratio_of(one, one), "samples.size() >= 2");
  EXPECT_BROKEN(ratio_of(one, two), "a.size() == b.size()");
}

}  // namespace
}  // namespace verisim::statistics_test
