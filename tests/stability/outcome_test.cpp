// What is stable, a limit cycle, diverged: by motions whose end is known from a formula.
#include "engine/stability/outcome.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "engine/stability/watch.hpp"

namespace verisim::stability::outcome_test {
namespace {

/// The judgement of x(0), x(1), … .
Outcome judged(const std::function<double(double)>& x, double scale = 1, const Patience& patience = {}) {
  SwingJudge judge(scale, patience);
  for (double i = 0;; ++i)
    if (const auto outcome = judge.take(x(i))) return *outcome;
}

/// exp(rate i) cos(i)
std::function<double(double)> oscillation(double rate) {
  return [rate](double i) { return std::exp(rate * i) * std::cos(i); };
}

TEST(Outcome, OfADecayIsStable) {
  for (const double rate : {-1.0, -1e-2, -1e-3, -1e-4, -3e-5})
    EXPECT_EQ(judged(oscillation(rate)), Outcome::stable) << rate;
}

TEST(Outcome, OfWhatIsBoundedAndNeverDecaysIsALimitCycle) {
  EXPECT_EQ(judged(oscillation(0)), Outcome::limit_cycle);
  EXPECT_EQ(judged([](double i) { return i < 1000 ? 10 * std::cos(i) : 3 * std::cos(0.7 * i); }), Outcome::limit_cycle);
  // A transient that decays, to a cycle that stays.
  EXPECT_EQ(judged([](double i) { return std::exp(-0.01 * i) + 0.2 * std::cos(i); }), Outcome::limit_cycle);
  // One that grows, to a cycle that stays: van der Pol's, averaged.
  EXPECT_EQ(judged([](double i) { return 50 / std::sqrt(1 + 2499 * std::exp(-0.002 * i)) * std::cos(i); }),
            Outcome::limit_cycle);
}

TEST(Outcome, OfGrowthIsDiverged) {
  for (const double rate : {1.0, 1e-2, 1e-3, 1e-4, 3e-5})
    EXPECT_EQ(judged(oscillation(rate)), Outcome::diverged) << rate;
  EXPECT_EQ(judged([](double i) { return i; }), Outcome::diverged);
  EXPECT_EQ(judged([](double i) { return i < 200 ? 0.5 : std::nan(""); }), Outcome::diverged);
  EXPECT_EQ(judged([](double) { return std::numeric_limits<double>::infinity(); }), Outcome::diverged);
}

// It is not stable who falls out of the place where he was and rests elsewhere.
TEST(Outcome, OfARestElsewhereIsNotStable) {
  EXPECT_EQ(judged([](double i) { return 5 + std::exp(-0.01 * i) * std::cos(i); }), Outcome::limit_cycle);
}

TEST(Outcome, DoesNotDependOnTheUnitOfLength) {
  for (const double unit : {1e-12, 1e12})
    for (const double rate : {-1e-3, 0.0, 1e-3})
      EXPECT_EQ(judged([&](double i) { return unit * oscillation(rate)(i); }, unit), judged(oscillation(rate)));
}

// As the header says: who looks longer sees the same, but for decays slower than 1e-4 in a block.
TEST(Outcome, DoesNotDependOnHowLongOneLooks) {
  for (const std::uint64_t first : {64U, 128U, 512U, 2048U})
    for (const unsigned blocks : {8U, 12U, 14U})
      for (const double rate : {1e-3, 1e-4, 3e-5}) {
        SCOPED_TRACE(testing::Message() << first << " frames, " << blocks << " blocks, " << rate);
        EXPECT_EQ(judged(oscillation(-rate), 1, {first, blocks}), Outcome::stable);
        EXPECT_EQ(judged(oscillation(0), 1, {first, blocks}), Outcome::limit_cycle);
        EXPECT_EQ(judged(oscillation(rate), 1, {first, blocks}), Outcome::diverged);
      }
}

TEST(Bisection, FindsWhereStabilityEnds) {
  for (const double bound : {1e-3, 1.0, 7.0, 999.0}) {
    const auto found = last_stable(1e-4, 1e3, 1e-6, [&](double x) { return x < bound; });
    ASSERT_TRUE(found);
    EXPECT_LE(std::abs(*found / bound - 1), 1e-6);
  }
  EXPECT_FALSE(last_stable(1, 2, 1e-3, [](double) { return true; }));
  EXPECT_FALSE(last_stable(1, 2, 1e-3, [](double) { return false; }));
}

}  // namespace
}  // namespace verisim::stability::outcome_test
