#include "engine/compare/rates.hpp"

#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "engine/compare/bounds.hpp"
#include "tests/length.hpp"
#include "tests/support/broken.hpp"

namespace verisim::compare::rates_test {
namespace {

TimeRule rule_in_turns() {
  return {.effect = built_in_bounds().effect_interleaved, .alpha = kAlphaInTurns};
}

RateAsked asked(double slower, std::size_t comparisons, std::uint64_t seed) {
  return {.order = Order::in_turns, .repetitions = 200, .slower = slower, .comparisons = comparisons, .seed = seed};
}

// The promise, on the times that bench/baseline/times.csv recorded; the long form is for seeds that nobody chose.
TEST(Rates, FalseAlarmsAreUnderOnePercentAndFivePercentAreCaught) {
  const std::size_t comparisons = test::by_length<std::size_t>(20, 500, 4000);
  const Rate alike = measure_rate(built_in_times(), asked(0, comparisons, 1), rule_in_turns());
  const Rate slower = measure_rate(built_in_times(), asked(0.05, comparisons, 1), rule_in_turns());
  RecordProperty("false_alarms", static_cast<int>(alike.worse + alike.better + alike.different));
  RecordProperty("caught", static_cast<int>(slower.worse));
  if (!test::kSanitized) {  // of 20 comparisons no rate is seen
    EXPECT_LT(static_cast<double>(alike.worse + alike.better + alike.different),
              0.01 * static_cast<double>(comparisons));
    EXPECT_GT(static_cast<double>(slower.worse), 0.95 * static_cast<double>(comparisons));
  }
  EXPECT_LT(slower.seconds, 600);
}

// The alarm itself: a rule that takes any difference for one has to show.
TEST(Rates, SeeARuleThatIsTooEasy) {
  const Rate rate = measure_rate(built_in_times(), asked(0, 100, 2), {.effect = 0, .alpha = 0.5});
  EXPECT_GT(rate.worse + rate.better + rate.different, 20U);
}

TEST(Rates, OfSyntheticTimesAreWhatTheTestPromises) {
  RecordedTimes recorded{{{"process_s", "s"}}, {}};
  const RandomStream random(5, "rates_test");
  for (std::uint64_t i = 0; i < 4000; ++i) recorded.runs.push_back({1 + 0.1 * random.uniform(i)});
  const std::size_t comparisons = test::by_length<std::size_t>(50, 1000, 4000);
  const RateAsked alike = {
      .order = Order::apart, .repetitions = 20, .slower = 0, .comparisons = comparisons, .seed = 1};
  const Rate rate = measure_rate(recorded, alike, {.effect = 0, .alpha = 0.05});
  // 5 % by the theory, a little below for a discrete statistic; four standard errors.
  EXPECT_LE(lower_bound(rate.worse + rate.better, comparisons), 0.05);
  if (!test::kSanitized) {
    EXPECT_GE(upper_bound(rate.worse + rate.better, comparisons), 0.03);
  }
}

// Clopper and Pearson: of 0 in n the upper bound is 1 - 0.05^(1/n), the "rule of three"; of n in n the lower
// 0.05^(1/n).
TEST(Bounds, OfRatesAreClopperAndPearsons) {
  EXPECT_NEAR(upper_bound(0, 300), 0.0099361, 1e-6);
  EXPECT_NEAR(lower_bound(300, 300), 1 - 0.0099361, 1e-6);
  EXPECT_NEAR(upper_bound(1, 10), 0.3941633, 1e-6);  // tables of the binomial distribution
  EXPECT_NEAR(lower_bound(9, 10), 1 - 0.3941633, 1e-6);
  EXPECT_EQ(upper_bound(3, 3), 1);
  EXPECT_EQ(lower_bound(0, 3), 0);
}

TEST(ReadTimes, TakesWhatProgramsWrites) {
  const RecordedTimes recorded =
      read_times("t.csv", "# from here\npair,program,process_s,frame_ns.p50\n0,B,1.5,10\n0,A,2,11\n");
  ASSERT_EQ(recorded.figures.size(), 2U);
  EXPECT_EQ(recorded.figures[1].name, "frame_ns.p50");
  EXPECT_EQ(recorded.figures[1].unit, "ns");
  EXPECT_EQ(recorded.runs, (std::vector<RunTimes>{{1.5, 10}, {2, 11}}));
  for (const char* broken :
       {"", "process_s\n", "process_s\nnan\n", "process_s\n0\n", "process_s\n1,2\n", "pair,program\n0,A\n"})
    EXPECT_THROW((void)read_times("t.csv", broken), Error) << broken;
}

TEST(Order, OfPairsIsDrawnAndStaysTheSame) {
  int b_first = 0;
  for (std::uint64_t pair = 0; pair < 1000; ++pair) {
    b_first += is_b_first(7, pair) ? 1 : 0;
    EXPECT_EQ(is_b_first(7, pair), is_b_first(7, pair));
  }
  EXPECT_NEAR(b_first, 500, 64);  // four standard errors
}

TEST(RatesDeathTest, NeedTwiceTheRepetitions) {
  const RecordedTimes recorded{{{"process_s", "s"}}, {{1.0}, {1.0}}};
  EXPECT_BROKEN(measure_rate(recorded, asked(0, 1, 1), rule_in_turns()), "recorded.runs.size() >= needed");
}

}  // namespace
}  // namespace verisim::compare::rates_test
