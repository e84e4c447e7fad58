#include "engine/compare/comparison.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/error.hpp"
#include "engine/base/text_table.hpp"
#include "engine/compare/bounds.hpp"
#include "engine/compare/figure_kinds.hpp"
#include "tests/support/broken.hpp"

namespace verisim::compare::comparison_test {
namespace {

Comparison with_count(Change change) {
  Comparison c;
  c.counts.push_back({"points", std::uint64_t{1}, std::uint64_t{2}, change});
  return c;
}

TEST(Verdict, FollowsFromTheWorstThatIsNotContradicted) {
  EXPECT_EQ(verdict_of({}), Verdict::same);
  EXPECT_EQ(verdict_of(with_count(Change::worse)), Verdict::worse);
  EXPECT_EQ(verdict_of(with_count(Change::better)), Verdict::better);
  EXPECT_EQ(verdict_of(with_count(Change::changed)), Verdict::different);
  EXPECT_EQ(verdict_of(with_count(Change::bits)), Verdict::different);
  Comparison both = with_count(Change::worse);
  both.counts.push_back({"voxels", std::uint64_t{2}, std::uint64_t{1}, Change::better});
  EXPECT_EQ(verdict_of(both), Verdict::different);
  Comparison stuck = with_count(Change::better);  // cheaper, because it did something else
  stuck.outcomes.push_back({"outcome", "inserted", "stuck", Change::changed});
  EXPECT_EQ(verdict_of(stuck), Verdict::different);
  Comparison rounded = with_count(Change::better);  // other bits alone take nothing from a gain
  rounded.accuracy.push_back({"state_hash", "a", "b", 0.0, Change::bits});
  EXPECT_EQ(verdict_of(rounded), Verdict::better);
  Comparison lonely;
  lonely.only_b.push_back("BM_new");
  EXPECT_EQ(verdict_of(lonely), Verdict::different);
}

TEST(Reasons, NameWhatTheVerdictComesFrom) {
  Comparison c = with_count(Change::worse);
  for (const char* name : {"a", "b", "c"}) c.counts.push_back({name, Value(), Value(), Change::worse});
  EXPECT_EQ(reasons_of(c), (std::vector<std::string>{"points, a, b and 1 more are higher"}));
  EXPECT_TRUE(reasons_of({}).empty());
}

TEST(Bounds, OfTheProgramHaveASource) {
  const Bounds& bounds = built_in_bounds();
  EXPECT_GT(bounds.effect_interleaved, 0);
  EXPECT_LT(bounds.effect_interleaved, 0.05);  // of 5 %, which have to be caught
  for (const auto& [name, bound] : bounds.figures) EXPECT_FALSE(bound.source.empty()) << name;
}

TEST(Bounds, JudgeByTheLargerOfBothAndInItsDirection) {
  Bounds bounds;
  bounds.figures["depth"] = {.relative = 0.1, .absolute = 0.5, .less_is_better = true, .source = "here"};
  bounds.figures["measure"] = {.relative = 0, .absolute = 1, .less_is_better = false, .source = "here"};
  EXPECT_EQ(bounds.judge("depth", 10, 10).change, Change::none);
  EXPECT_EQ(bounds.judge("depth", 10, 10).note, "");
  EXPECT_EQ(bounds.judge("depth", 10, 11).change, Change::none);  // within 10 %
  EXPECT_EQ(bounds.judge("depth", 10, 11).note, "within the bound");
  EXPECT_EQ(*bounds.judge("depth", 10, 11).bound, 1);
  EXPECT_EQ(bounds.judge("depth", 1, 1.4).change, Change::none);  // within 0.5
  EXPECT_EQ(bounds.judge("depth", 1, 1.6).change, Change::worse);
  EXPECT_EQ(bounds.judge("depth", 1, 0.4).change, Change::better);
  EXPECT_EQ(bounds.judge("passes", 1, 2.5).change, Change::changed);
  EXPECT_EQ(bounds.judge("depth", 1, NAN).change, Change::changed);
  EXPECT_EQ(bounds.judge("depth", NAN, NAN).change, Change::none);  // the same bits
}

TEST(Bounds, AreRefusedWithoutASourceOrANumber) {
  const std::string good = R"({"figures": {"measure": {"relative": 0.1, "source": "x"}},
      "outcome_flips": {"bound": 0, "source": "x"}, "times_interleaved": {"bound": 0.02, "source": "x"},
      "times_apart": {"bound": 1, "source": "x"}})";
  EXPECT_EQ(read_bounds("b.json", good).effect_apart, 1);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  EXPECT_THROW((void)read_bounds("b.json", "[]"), Error);
  EXPECT_THROW((void)read_bounds("b.json", "{}"), Error);
  EXPECT_THROW((void)read_bounds("b.json", with("\"relative\": 0.1, \"source\": \"x\"", "\"relative\": 0.1")), Error);
  EXPECT_THROW((void)read_bounds("b.json", with("0.1", "-0.1")), Error);
  EXPECT_THROW((void)read_bounds("b.json", with("\"measure\"", "\"depth\"")), Error);
  EXPECT_THROW((void)read_bounds("b.json", with("times_apart", "times")), Error);
}

TEST(FigureKinds, WorkIsBetterWhenThereIsLessOfIt) {
  EXPECT_EQ(change_of_count("/cost/points_tested", true), Change::worse);
  EXPECT_EQ(change_of_count("cost.points_tested", false), Change::better);
  EXPECT_EQ(change_of_count("frames", false), Change::changed);
  EXPECT_EQ(kind_of_figure("wall_s"), FigureKind::skipped);
  EXPECT_EQ(kind_of_figure("frames"), FigureKind::count);
  EXPECT_EQ(kind_of_figure("outcome"), FigureKind::word);
  EXPECT_EQ(kind_of_figure("max_force_N"), FigureKind::number);
  EXPECT_EQ(kind_of_figure("what a scenario measures"), FigureKind::number);
}

TEST(TextTable, LinesUp) {
  TextTable table({"what", "A", "why"});
  table.add({"µ", "1", "x"});
  table.add({"long name", "100", ""});
  EXPECT_EQ(table.text(),
            "  what         A  why\n"
            "  µ            1  x\n"
            "  long name  100\n");
}

TEST(TextTableDeathTest, NeedsACellForEachColumn) {
  TextTable table({"a", "b"});
  EXPECT_BROKEN(table.add({"one"}), "cells.size() == rows_.front().size()");
}

}  // namespace
}  // namespace verisim::compare::comparison_test
