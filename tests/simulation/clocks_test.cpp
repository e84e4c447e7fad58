#include "engine/simulation/clocks.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "engine/base/error.hpp"

namespace verisim::clocks_test {
namespace {

std::vector<std::uint64_t> due_frames(double dt, double rate_hz, std::uint64_t frames) {
  Clocks clocks(dt);
  std::vector<std::uint64_t> due;
  std::uint64_t now = 0;
  clocks.add(rate_hz, [&](double) { due.push_back(now); });
  for (now = 1; now <= frames; ++now) clocks.run_due(now, static_cast<double>(now) * dt);
  return due;
}

// Tick k of 60 Hz is due at the first millisecond not before k / 60 s: ceil(1000 k / 60).
TEST(Clocks, SixtyHertzNeverDrifts) {
  const std::vector<std::uint64_t> due = due_frames(0.001, 60, 3'600'000);
  ASSERT_EQ(due.size(), 216'000U);  // one hour
  for (std::uint64_t k = 1; k <= due.size(); ++k) EXPECT_EQ(due[k - 1], (1000 * k + 59) / 60) << "tick " << k;
}

TEST(Clocks, AClockFasterThanTheLoopTicksSeveralTimesAFrame) {
  EXPECT_EQ(due_frames(0.001, 2500, 4).size(), 10U);
}

TEST(Clocks, RunInTheOrderOfAdding) {
  Clocks clocks(0.001);
  std::vector<int> order;
  clocks.add(100, [&](double) { order.push_back(1); });
  clocks.add(60, [&](double) { order.push_back(2); });
  clocks.run_due(50, 0.05);  // five ticks of the first, three of the second
  EXPECT_EQ(order, (std::vector<int>{1, 1, 1, 1, 1, 2, 2, 2}));
}

TEST(Clocks, RefuseRatesThatAreNone) {
  Clocks clocks(0.001);
  for (const double rate : {0.0, -60.0, 1e7, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW(clocks.add(rate, [](double) {}), Error) << rate;
}

}  // namespace
}  // namespace verisim::clocks_test
