// Dissertation table 7.1: its own regressions from its own rows, and our table's form.
#include "engine/constraint/recognition_table.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/contact/allocations.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::recognition_table_test {
namespace {

using test::tolerance;

TEST(FitLine, FindsALineExactly) {
  const std::vector<double> x = {0, 1, 2, 5};
  const std::vector<double> y = {1, 3, 5, 11};
  const Regression line = fit_line(x, y);
  EXPECT_NEAR(line.slope, 2, tolerance(1e-15));
  EXPECT_NEAR(line.intercept, 1, tolerance(1e-14));
  EXPECT_NEAR(line.r_squared, 1, tolerance(1e-15));
}

// By hand: x 0 1 2, y 0 1 0: slope 0, nothing explained.
TEST(FitLine, SaysWhenNothingIsExplained) {
  const std::vector<double> x = {0, 1, 2};
  const std::vector<double> y = {0, 1, 0};
  EXPECT_EQ(fit_line(x, y).r_squared, 0);
  const std::vector<double> flat = {4, 4, 4};
  EXPECT_EQ(fit_line(x, flat).r_squared, 0);
}

TEST(RecognitionTable, HoldsEveryChoiceOfTheSixRecognizers) {
  const RecognitionTable table = measure_recognition_table(/*rounds=*/2, /*ms_per_row=*/0.05);
  ASSERT_EQ(table.rows.size(), 64U);
  EXPECT_EQ(std::count_if(table.rows.begin(), table.rows.end(), [](const auto& r) { return r.specializations() == 3; }),
            20);
  EXPECT_EQ(table.rows.front().constraints(), 0);
  EXPECT_EQ(table.rows.back().constraints(), 8);
  for (const RecognitionRow& row : table.rows) {
    EXPECT_GT(row.ns_per_pair, 0);
    EXPECT_LT(row.ns_per_pair, 1e4);
  }
  EXPECT_GT(table.bare_visit_ns, 0);
}

}  // namespace
}  // namespace verisim::recognition_table_test
