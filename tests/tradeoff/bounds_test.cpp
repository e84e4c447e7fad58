// Units of the command line, kinds of error, and the setting that answers.
#include "engine/tradeoff/bounds.hpp"

#include <gtest/gtest.h>

#include "engine/base/error.hpp"

namespace verisim::bounds_test {
namespace {

using namespace tradeoff;

Row row_of(double us, double force) {
  Row row;
  row.time_us = {us, us, us, us};
  row.step_s = 0.001;
  row.errors[index_of(Kind::force)] = Spread{force, force};
  return row;
}

TEST(Quantity, IsANumberWithAUnit) {
  EXPECT_DOUBLE_EQ(quantity_from("x", "200us").value, 200e-6);
  EXPECT_DOUBLE_EQ(quantity_from("x", "0.01 mm").value, 1e-5);
  EXPECT_DOUBLE_EQ(quantity_from("x", "5mN").value, 5e-3);
  EXPECT_EQ(quantity_from("x", "5 mNm").unit, "N m");
  EXPECT_EQ(quantity_from("x", "5 N m").unit, "N m");
  EXPECT_EQ(quantity_from("x", "2m").unit, "m");
  EXPECT_DOUBLE_EQ(quantity_from("x", "180deg").value, 3.14159265358979323846);
  EXPECT_DOUBLE_EQ(quantity_from("x", "5%").value, 0.05);
  EXPECT_EQ(quantity_from("x", "0.05").unit, "1");
  for (const char* text : {"", "N", "1 lb", "nan", "inf", "1e999", "1 mm mm", "--1"})
    EXPECT_THROW((void)quantity_from("x", text), Error) << text;
}

TEST(Bounds, TakeTheKindFromTheUnit) {
  EXPECT_EQ(error_bound_from("e", "0.05N", "").kind, Kind::force);
  EXPECT_EQ(error_bound_from("e", "0.05N", "force_max").kind, Kind::force_max);
  EXPECT_EQ(error_bound_from("e", "0.01mm", "").kind, Kind::overlap);
  EXPECT_EQ(error_bound_from("e", "0.01mm", "position").kind, Kind::position);
  EXPECT_EQ(error_bound_from("e", "5%", "").kind, Kind::wrench);
  EXPECT_EQ(error_bound_from("e", "1mJ", "").kind, Kind::work);
  EXPECT_THROW((void)error_bound_from("e", "0.01mm", "force"), Error);
  EXPECT_THROW((void)error_bound_from("e", "1us", ""), Error);
  EXPECT_THROW((void)error_bound_from("e", "0N", ""), Error);
  EXPECT_THROW((void)error_bound_from("e", "1N", "weight"), Error);
  EXPECT_DOUBLE_EQ(budget_from("b", "200us"), 200);
  EXPECT_THROW((void)budget_from("b", "200"), Error);
  EXPECT_THROW((void)budget_from("b", "-1us"), Error);
}

TEST(Bounds, AreToldInTheirUnits) {
  EXPECT_EQ(text_of(Bounds{.budget_us = 20, .error = ErrorBound{Kind::force, 2}}),
            "a median frame with contact of at most 20 us and an error 'force' of at most 2 N");
  EXPECT_EQ(text_of(Bounds{.budget_us = {}, .error = ErrorBound{Kind::wrench, 0.05}}),
            "an error 'wrench' of at most 0.05");
}

TEST(Choose, IsTheCheapestWithinAnErrorOrTheMostAccurateWithinABudget) {
  std::vector<Row> rows = {row_of(10, 5), row_of(20, 1), row_of(50, 0.1), row_of(1, 0)};
  rows[3].failed = "it crashed";
  const auto by_error = [&](double most) {
    return choose(rows, {.budget_us = {}, .error = ErrorBound{Kind::force, most}}, Kind::force);
  };
  EXPECT_EQ(by_error(10), 0u);
  EXPECT_EQ(by_error(1), 1u);
  EXPECT_EQ(by_error(0.01), std::nullopt);
  const auto by_budget = [&](double us) { return choose(rows, {.budget_us = us, .error = {}}, Kind::force); };
  EXPECT_EQ(by_budget(30), 1u);
  EXPECT_EQ(by_budget(5), std::nullopt);
  EXPECT_EQ(choose(rows, {.budget_us = 15, .error = ErrorBound{Kind::force, 1}}, Kind::force), std::nullopt);
}

// The bound holds for the worst repetition, not for the middle one.
TEST(Choose, HoldsABoundAgainstTheWorst) {
  std::vector<Row> rows = {row_of(10, 5), row_of(20, 1)};
  rows[0].errors[index_of(Kind::force)]->median = 0;
  EXPECT_EQ(choose(rows, {.budget_us = {}, .error = ErrorBound{Kind::force, 2}}, Kind::force), 1u);
  rows[1].time_us.most = 100;
  EXPECT_EQ(choose(rows, {.budget_us = 30, .error = {}}, Kind::force), 0u);
}

TEST(Choose, IsAsFarFromTheBoundsAsCanBeWhereThatIsPreferred) {
  const std::vector<Row> rows = {row_of(10, 5), row_of(20, 1), row_of(50, 0.1)};
  const Bounds error{.budget_us = {}, .error = ErrorBound{Kind::force, 10}};
  EXPECT_EQ(choose(rows, error, Kind::force, Prefer::most_accurate), 2u);
  const Bounds both{.budget_us = 30, .error = ErrorBound{Kind::force, 10}};
  EXPECT_EQ(choose(rows, both, Kind::force, Prefer::most_accurate), 1u) << "a budget is kept all the same";
}

TEST(Coverage, IsToldWithWhatMakesItEnough) {
  EXPECT_EQ(coverage_text(3),
            "bounds that all 3 repetitions kept are expected to hold in 75 % of further trials; "
            "--repeat 19 makes it 95 %");
  EXPECT_EQ(coverage_text(19), "bounds that all 19 repetitions kept are expected to hold in 95 % of further trials");
  EXPECT_NE(coverage_text(1).find("the one repetition kept are expected to hold in 50 %"), std::string::npos);
}

}  // namespace
}  // namespace verisim::bounds_test
