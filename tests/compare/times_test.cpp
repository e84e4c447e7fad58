#include "engine/compare/times.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine/base/random.hpp"
#include "tests/support/broken.hpp"

namespace verisim::compare::times_test {
namespace {

constexpr TimeRule kRule = {.effect = 0.025, .alpha = 0.01};

/// Times around `middle` that scatter by 1 %.
std::vector<double> times_around(double middle, std::size_t n, const char* stream) {
  const RandomStream random(1, stream);
  std::vector<double> times;
  for (std::uint64_t i = 0; i < n; ++i) times.push_back(middle * (1 + 0.01 * random.normal(i)));
  return times;
}

TimeSamples samples_of(double ratio, std::size_t n, bool is_paired) {
  return {.name = "t",
          .unit = "s",
          .a = times_around(2, n, "a"),
          .b = times_around(2 * ratio, n, "b"),
          .is_paired = is_paired};
}

TimeFigure judged(const TimeSamples& samples, const TimeRule& rule = kRule) {
  return judge_times(std::vector{samples}, rule)[0];
}

TEST(JudgeTimes, TellsSlowerAndFasterByFivePercent) {
  for (const bool is_paired : {false, true}) {
    const TimeFigure slower = judged(samples_of(1.05, 20, is_paired));
    EXPECT_EQ(slower.change, TimeChange::slower);
    EXPECT_NEAR(slower.ratio, 1.05, 0.02);
    EXPECT_LT(*slower.low, 1.05);
    EXPECT_GT(*slower.high, 1.05);
    EXPECT_LT(*slower.p, 1e-4);
    EXPECT_EQ(judged(samples_of(1 / 1.05, 20, is_paired)).change, TimeChange::faster);
    EXPECT_EQ(judged(samples_of(1, 20, is_paired)).change, TimeChange::none);
  }
}

// Sure, but not worth a word: 1 % of 200 repetitions that scatter by 1 % has p far below alpha.
TEST(JudgeTimes, LetsASmallDifferencePassHoweverSureItIs) {
  const TimeFigure small = judged(samples_of(1.01, 200, true));
  EXPECT_LT(*small.p, 1e-6);
  EXPECT_EQ(small.change, TimeChange::none);
}

// Worth a word, but not sure: 4 pairs cannot have a p below 2^-3.
TEST(JudgeTimes, SaysThatFewRepetitionsAreTooFew) {
  const TimeFigure few = judged(samples_of(2, 4, true));
  EXPECT_EQ(few.change, TimeChange::unknown);
  EXPECT_EQ(few.note, "4 of each: too few for a verdict on time");
  EXPECT_FALSE(few.low);
  const TimeFigure one = judged(samples_of(2, 1, false));
  EXPECT_EQ(one.change, TimeChange::unknown);
  EXPECT_EQ(one.note, "one repetition: no verdict on time");
  EXPECT_FALSE(one.p);
}

TEST(JudgeTimes, PairsTakeAwayWhatBothHaveInCommon) {
  TimeSamples samples = samples_of(1.05, 40, true);
  for (std::size_t i = 0; i < 40; ++i) {  // the machine doubles its time on the way
    samples.a[i] *= 1 + 0.025 * static_cast<double>(i);
    samples.b[i] *= 1 + 0.025 * static_cast<double>(i);
  }
  EXPECT_EQ(judged(samples).change, TimeChange::slower);
  samples.is_paired = false;
  EXPECT_EQ(judged(samples).change, TimeChange::none);
}

// 60 figures: one p of 0.001 among them is no wonder.
TEST(JudgeTimes, CorrectsForTheNumberOfFigures) {
  TimeSamples doubtful = samples_of(1.03, 7, false);
  doubtful.a = {1, 2, 3, 4, 5, 6, 7};  // apart from each other: p = 2 / 3432
  doubtful.b = {11, 12, 13, 14, 15, 16, 17};
  EXPECT_EQ(judged(doubtful).change, TimeChange::slower);
  std::vector<TimeSamples> many(60, samples_of(1, 20, false));
  many.push_back(doubtful);
  const TimeFigure among_many = judge_times(many, kRule).back();
  EXPECT_EQ(among_many.change, TimeChange::unknown);  // 61 x 2 / 3432 is above alpha: that few can never be sure
  for (TimeSamples& s : many) s.is_judged = false;
  many.back().is_judged = true;
  EXPECT_EQ(judge_times(many, kRule).back().change, TimeChange::slower);
  EXPECT_EQ(judge_times(many, kRule).front().change, TimeChange::unknown);
}

TEST(JudgeTimesDeathTest, NeedsTimes) {
  TimeSamples broken = samples_of(1, 3, true);
  broken.b.pop_back();
  EXPECT_BROKEN(judged(broken), "!s.is_paired || s.a.size() == s.b.size()");
  broken.b.push_back(0);
  EXPECT_BROKEN(judged(broken), "time > 0");
  broken.b.back() = INFINITY;
  EXPECT_BROKEN(judged(broken), "std::isfinite(time)");
  EXPECT_BROKEN(judged(samples_of(1, 3, true), {.effect = 0, .alpha = 0}), "rule.alpha > 0");
  EXPECT_BROKEN(judged(samples_of(1, 3, true), {.effect = -1, .alpha = 0.1}), "rule.effect >= 0");
}

}  // namespace
}  // namespace verisim::compare::times_test
