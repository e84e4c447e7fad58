// Tables of settings: intervals, dominance and fronts, files and back.
#include "engine/tradeoff/table.hpp"

#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"

namespace verisim::table_test {
namespace {

using namespace tradeoff;

Row row_of(double us, double force) {
  Row row;
  row.time_us = row.frame_us = {us, us, us, us};
  row.step_s = 0.001;
  row.frames = 10;
  row.cost = {{"contacts", 7}};
  row.errors[index_of(Kind::force)] = Spread{force / 2, force};
  row.parameters["voxelsize"] = 0.001 * us;
  row.parameters["hybrid"] = "exact";
  return row;
}

// Of 9 values the second from either end bounds the median with 96.1 %, the third with 82 %: the second it is.
// (Of 6 the ends have 96.9 %; of 5 nothing has 95 %, so the range is told.)
TEST(Interval, IsOfOrderStatistics) {
  const Interval nine = interval_of({9, 1, 8, 2, 7, 3, 6, 4, 5});
  EXPECT_EQ(nine.median, 5);
  EXPECT_EQ(nine.low, 2);
  EXPECT_EQ(nine.high, 8);
  EXPECT_EQ(nine.most, 9);
  const Interval six = interval_of({1, 2, 3, 4, 5, 6});
  EXPECT_EQ(six.median, 3.5);
  EXPECT_EQ(six.low, 1);
  EXPECT_EQ(six.high, 6);
  EXPECT_EQ(interval_of({4}).low, 4);
  EXPECT_EQ(interval_of({4}).high, 4);
}

// The interval holds the true median at least as often as it says: 2000 samples of 15 normal numbers, whose median is
// 0.
TEST(Interval, HoldsTheMedianAsOftenAsItSays) {
  const RandomStream stream(3, "median");
  int held = 0;
  for (std::uint64_t sample = 0; sample < 2000; ++sample) {
    std::vector<double> values;
    for (std::uint64_t i = 0; i < 15; ++i) values.push_back(stream.normal(15 * sample + i));
    const Interval interval = interval_of(values);
    held += interval.low <= 0 && 0 <= interval.high ? 1 : 0;
  }
  EXPECT_GE(held, 1900);
  EXPECT_LE(held, 1970);  // and is not so wide that it says nothing: 96.5 % are expected
}

// The greatest of n holds a further one with n / (n + 1): by trying, for 19 of them, 95 %.
TEST(Coverage, IsWhatFurtherTrialsFind) {
  const RandomStream stream(4, "coverage");
  int held = 0;
  for (std::uint64_t sample = 0; sample < 4000; ++sample) {
    double most = 0;
    for (std::uint64_t i = 0; i < 19; ++i) most = std::max(most, stream.uniform(20 * sample + i));
    held += stream.uniform(20 * sample + 19) <= most ? 1 : 0;
  }
  EXPECT_EQ(coverage_of(19), 0.95);
  EXPECT_NEAR(held / 4000.0, 0.95, 3 * std::sqrt(0.95 * 0.05 / 4000));
}

TEST(Front, IsWhatNothingDominates) {
  std::vector<Row> rows = {row_of(10, 5), row_of(20, 1), row_of(15, 6), row_of(30, 1), row_of(10, 5), row_of(5, 9)};
  rows.push_back(row_of(1, 0));
  rows.back().failed = "as it was told";
  find_dominated(rows, Kind::force);
  EXPECT_EQ(front_of(rows, Kind::force), (std::vector<std::size_t>{5, 0, 4, 1}));  // equal ones dominate each other not
  EXPECT_EQ(rows[2].dominated, 0u);
  EXPECT_EQ(rows[3].dominated, 1u);
  EXPECT_FALSE(rows[6].dominated);
}

// By definition, for every pair of 60 random rows.
TEST(Front, IsThatOfThePlainDefinition) {
  const RandomStream stream(5, "front");
  std::vector<Row> rows;
  for (std::uint64_t i = 0; i < 60; ++i)
    rows.push_back(row_of(1 + std::floor(8 * stream.uniform(2 * i)), std::floor(8 * stream.uniform(2 * i + 1))));
  find_dominated(rows, Kind::force);
  const auto error = [](const Row& row) { return row.errors[index_of(Kind::force)]->most; };
  for (const Row& a : rows) {
    bool dominated = false;
    for (const Row& b : rows)
      dominated |= b.load() <= a.load() && error(b) <= error(a) && (b.load() < a.load() || error(b) < error(a));
    EXPECT_EQ(a.dominated.has_value(), dominated);
    if (a.dominated) {
      EXPECT_FALSE(rows[*a.dominated].dominated) << "the one that is named is on the front";
    }
  }
}

// Half the step is twice the frames: the same frame time is twice the load.
TEST(Front, CountsTheFramesOfAFinerStep) {
  std::vector<Row> rows = {row_of(10, 5), row_of(10, 5)};
  rows[1].step_s = 0.0005;
  find_dominated(rows, Kind::force);
  EXPECT_EQ(rows[1].dominated, 0u);
}

TEST(Table, ComesBackFromItsFile) {
  Table table;
  table.scenario = "a.lua";
  table.by = Kind::force;
  table.repeat = 3;
  table.fixed["clearance"] = 0.005;
  table.rows = {row_of(10, 5), row_of(20, 1), row_of(30, 1)};
  table.rows[2].failed = "no, \"quoted\"";
  find_dominated(table.rows, table.by);
  const Table back = table_from("t.json", json_of(table).dump());
  EXPECT_EQ(back.scenario, "a.lua");
  EXPECT_EQ(back.repeat, 3u);
  ASSERT_EQ(back.rows.size(), 3u);
  EXPECT_EQ(back.rows[1].parameters, table.rows[1].parameters);
  EXPECT_EQ(back.rows[1].time_us.high, 20);
  EXPECT_EQ(back.rows[1].errors[index_of(Kind::force)]->most, 1);
  EXPECT_FALSE(back.rows[1].errors[index_of(Kind::overlap)]);
  EXPECT_EQ(back.rows[2].failed, table.rows[2].failed);
}

// Every text that a file may be cut to, and every field that may be missing or of another type, is an error and no
// crash.
TEST(Table, ThatIsDamagedIsRefused) {
  Table table;
  table.rows = {row_of(10, 5), row_of(20, 1)};
  const std::string text = json_of(table).dump();
  for (std::size_t size = 0; size < text.size(); size += 7)
    EXPECT_THROW((void)table_from("t.json", text.substr(0, size)), Error);
  const nlohmann::ordered_json whole = json_of(table);
  for (const char* field : {"format", "format_version", "scenario", "machine", "repeat", "fixed", "by", "rows"}) {
    nlohmann::ordered_json less = whole;
    less.erase(field);
    EXPECT_THROW((void)table_from("t.json", less.dump()), Error) << field;
    less[field] = nlohmann::ordered_json::array({1});
    EXPECT_THROW((void)table_from("t.json", less.dump()), Error) << field;
  }
  for (const char* field : {"time_us", "errors", "step_s", "parameters", "cost"}) {
    nlohmann::ordered_json other = whole;
    other["rows"][1][field] = -1;
    EXPECT_THROW((void)table_from("t.json", other.dump()), Error) << field;
  }
}

// The reader of the message is told the place and what to do, not what a parser thinks.
TEST(Table, ThatIsDamagedIsToldWithItsPlace) {
  Table table;
  table.rows = {row_of(10, 5), row_of(20, 1)};
  const nlohmann::ordered_json whole = json_of(table);
  const auto told = [](const std::string& text) {
    try {
      (void)table_from("t.json", text);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      return std::string(error.what());
    }
    return std::string("taken");
  };
  const std::string cut = whole.dump(1);
  EXPECT_EQ(
      told(cut.substr(0, cut.find("\"commit\"") + 4)),
      "t.json: is no table of 'verisim tradeoff': line 5 is no JSON, or the file ends in it; make it with verisim "
      "tradeoff -o FOLDER");
  EXPECT_NE(told("[1]").find("it is no object"), std::string::npos);
  nlohmann::ordered_json other = whole;
  other["rows"][1]["time_us"]["most"] = "fast";
  EXPECT_NE(told(other.dump()).find("rows[1].time_us.most is no number;"), std::string::npos);
  other["rows"][1]["time_us"]["most"] = -1;
  EXPECT_NE(told(other.dump()).find("rows[1].time_us.most is below 0;"), std::string::npos);
  other = whole;
  other["rows"][0]["errors"].erase("force");
  EXPECT_NE(told(other.dump()).find("rows[0].errors.force is not there;"), std::string::npos);
  for (const auto& [field, value] : whole.items()) {
    other = whole;
    other[field] = nlohmann::ordered_json::array({nullptr});
    EXPECT_EQ(told(other.dump()).find("exception"), std::string::npos) << field;
    other.erase(field);
    EXPECT_EQ(told(other.dump()).find("exception"), std::string::npos) << field;
  }
}

TEST(Table, SaysItsCoverage) {
  Table table;
  table.repeat = 3;
  EXPECT_EQ(json_of(table).at("coverage"), 0.75);
  table.repeat = 19;
  EXPECT_EQ(json_of(table).at("coverage"), 0.95);
}

TEST(Table, HasAPlotOfWhateverItHolds) {
  Table table;
  EXPECT_NE(plot_of(table).find("<svg"), std::string::npos);
  table.rows = {row_of(10, 0), row_of(20, 0)};
  EXPECT_EQ(plot_of(table).find("nan"), std::string::npos);
  table.rows[1].failed = "x";
  EXPECT_NE(plot_of(table).find("<circle"), std::string::npos);
}

}  // namespace
}  // namespace verisim::table_test
