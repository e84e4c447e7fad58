#include "engine/batch/design.hpp"

#include <gtest/gtest.h>

#include <set>

#include "engine/base/error.hpp"

namespace verisim::batch::design_test {
namespace {

/// A scenario with numbers a, b and a text word; "2k" is 2000.
Cell as_value(const std::string& option, const std::string& key, const std::string& text) {
  if (key == "word") return text;
  if (key != "a" && key != "b") fail(ErrorKind::input, "{} {}={}: no parameter (a, b, word)", option, key, text);
  if (text == "2k") return 2000.0;
  std::size_t end = 0;
  double value = 0;
  try {
    value = std::stod(text, &end);
  } catch (const std::exception&) {
    end = 0;
  }
  if (end == 0 || end != text.size()) fail(ErrorKind::input, "{} {}={}: no number", option, key, text);
  return value;
}

DesignRequest grid() {
  DesignRequest request;
  request.vary = {"a=1,2,3", "word=x,y"};
  return request;
}

/// The error's kind; its text has all the words in it.
int refused(const DesignRequest& request, const std::vector<std::string>& words) {
  try {
    (void)make_design(request, as_value);
  } catch (const Error& error) {
    for (const std::string& word : words)
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what() << " has no " << word;
    return error.exit_code();
  }
  return 0;
}

TEST(Design, OfTwoAxesIsTheirProductAndTheLastIsFastest) {
  const Design design = make_design(grid(), as_value);
  ASSERT_EQ(design.runs(), 6u);
  std::string order;
  for (std::uint64_t run = 0; run < design.runs(); ++run)
    order += plain_text(design.point(run).values[0].cell) + plain_text(design.point(run).values[1].cell) + " ";
  EXPECT_EQ(order, "1x 1y 2x 2y 3x 3y ");
}

TEST(Design, PairsThePointsOfAGridByTheirSeeds) {
  DesignRequest request = grid();
  request.repeat = 4;
  const Design design = make_design(request, as_value);
  ASSERT_EQ(design.runs(), 24u);
  std::set<std::uint64_t> seeds;
  for (std::uint64_t run = 0; run < design.runs(); ++run) {
    EXPECT_EQ(design.point(run).seed, design.point(run % 4).seed) << run;
    seeds.insert(design.point(run).seed);
  }
  EXPECT_EQ(seeds.size(), 4u) << "each repetition has its own";
}

TEST(Design, HasTheSameSeedsWhateverItVariesAndHoweverOftenItRepeats) {
  DesignRequest few = grid(), many = grid();
  few.repeat = 2;
  many.repeat = 7;
  many.vary = {"b=4,5"};
  for (std::uint64_t r = 0; r < 2; ++r)
    EXPECT_EQ(make_design(few, as_value).point(r).seed, make_design(many, as_value).point(r).seed);
  few.seed = 2;
  EXPECT_NE(make_design(few, as_value).point(0).seed, make_design(many, as_value).point(0).seed);
}

TEST(Design, GivesEveryPointOfAGridTheSameDraws) {
  DesignRequest request = grid();
  request.random = {"5", "b=0..1"};
  request.repeat = 2;
  const Design design = make_design(request, as_value);
  ASSERT_EQ(design.runs(), 6u * 5 * 2);
  for (std::uint64_t run = 0; run < design.runs(); ++run) {
    const Cell drawn = design.point(run).values[2].cell;
    EXPECT_EQ(drawn, design.point(run % 10).values[2].cell) << run;
    EXPECT_EQ(drawn, design.point(run / 2 * 2).values[2].cell) << "the repetitions of a draw have its value";
    EXPECT_EQ(design.point(run).values[2].text, plain_text(drawn)) << "what is set is what is told";
  }
  EXPECT_NE(design.point(0).seed, design.point(2).seed) << "a draw is a repetition, too";
}

TEST(Design, TakesSeedsAndValuesFromATable) {
  DesignRequest request;
  request.design_name = "d.csv";
  request.design_content = "a, seed ,word\r\n1,18446744073709551615,x\n\n2k,7,\"y, z\"\n";
  const Design design = make_design(request, as_value);
  ASSERT_EQ(design.runs(), 2u);
  EXPECT_EQ(design.keys(), (std::vector<std::string>{"a", "word"}));
  EXPECT_EQ(design.point(0).seed, 18446744073709551615u);
  EXPECT_EQ(design.point(1).seed, 7u);
  EXPECT_EQ(design.point(1).values[0].cell, Cell(2000.0));
  EXPECT_EQ(plain_text(design.point(1).values[1].cell), "y, z");
}

TEST(Design, DividesIntoShardsThatTogetherHaveEachRunOnce) {
  DesignRequest request = grid();
  request.repeat = 5;
  for (const int of : {1, 2, 3, 4, 7, 30, 31}) {
    std::vector<int> found(30, 0);
    for (int i = 1; i <= of; ++i) {
      request.shard = std::to_string(i) + "/" + std::to_string(of);
      const Design design = make_design(request, as_value);
      std::uint64_t own = 0;
      for (std::uint64_t run = 0; run < design.runs(); ++run) {
        if (!design.has(run)) continue;
        ++found[run];
        ++own;
      }
      EXPECT_EQ(own, design.runs_of_shard()) << request.shard;
    }
    EXPECT_EQ(found, std::vector<int>(30, 1)) << of << " shards";
  }
}

TEST(Design, RefusesWhatContradictsItself) {
  const auto with = [](auto change) {
    DesignRequest request = grid();
    change(request);
    return request;
  };
  using R = DesignRequest&;
  EXPECT_EQ(refused(with([](R r) { r.vary.push_back("a=7"); }), {"'a'", "--vary a=1,2,3", "already"}), 2);
  EXPECT_EQ(refused(with([](R r) { r.set_keys = {"word"}; }), {"'word'", "--set word"}), 2);
  EXPECT_EQ(refused(with([](R r) { r.random = {"3", "a=0..1"}; }), {"'a'"}), 2);
  EXPECT_EQ(refused(with([](R r) { r.random = {"3"}; }), {"no parameter to draw"}), 2);
  EXPECT_EQ(refused(with([](R r) { r.random = {"b=0..1"}; }), {"number of draws comes first"}), 2);
  EXPECT_EQ(refused(with([](R r) { r.random = {"3", "b=0..1", "4"}; }), {"--random 3", "--random 4"}), 2);
  EXPECT_EQ(refused(with([](R r) { r.vary.pop_back(), r.random = {"3", "word=0..1"}; }), {"is no number"}), 2);
  EXPECT_EQ(refused(with([](R r) { r.vary = {"a="}; }), {"the grid is empty"}), 2);
  EXPECT_EQ(refused(with([](R r) { r.vary = {"a=1,,2"}; }), {"empty value"}), 2);
  EXPECT_EQ(refused(with([](R r) { r.vary = {"a=1,2k,2000"}; }), {"'2k'", "'2000'", "one value"}), 2);
  EXPECT_EQ(refused(with([](R r) { r.vary = {"a"}; }), {"KEY="}), 2);
  EXPECT_EQ(refused(with([](R r) { r.vary = {"c=1"}; }), {"--vary c=1: no parameter", "a, b, word"}), 3);
  EXPECT_EQ(refused(with([](R r) { r.repeat = 0; }), {"--repeat 0"}), 2);
  for (const char* shard : {"3/2", "0/2", "1/0"})
    EXPECT_EQ(refused(with([&](R r) { r.shard = shard; }), {"--shard", "1 to N"}), 2) << shard;
  for (const char* shard : {"1", "a/2", "1/", "-1/2", "1/2/3"})
    EXPECT_EQ(refused(with([&](R r) { r.shard = shard; }), {"--shard"}), 2) << shard;
}

TEST(Design, RefusesABadTableWithItsLine) {
  const auto table = [](const std::string& content) {
    DesignRequest request;
    request.design_name = "d.csv";
    request.design_content = content;
    return request;
  };
  EXPECT_EQ(refused(table(""), {"d.csv", "is empty"}), 3);
  EXPECT_EQ(refused(table("a,word\n"), {"d.csv", "no run"}), 3);
  EXPECT_EQ(refused(table("a,word\n1,x\n2\n"), {"d.csv:3", "1 values", "2 columns"}), 3);
  EXPECT_EQ(refused(table("a,word\n1,\n"), {"d.csv:2", "'word' is empty"}), 3);
  EXPECT_EQ(refused(table("a,c\n1,2\n"), {"d.csv:2: c=2: no parameter"}), 3);
  EXPECT_EQ(refused(table("a,a\n1,2\n"), {"d.csv:1", "'a'"}), 3);
  EXPECT_EQ(refused(table("a,seed\n1,-2\n"), {"d.csv:2", "seed", "-2"}), 3);
  EXPECT_EQ(refused(table("a,\n1,2\n"), {"d.csv:1", "column 2 has no name"}), 3);
  EXPECT_EQ(refused(table("a,word\n1,\"x\n2,y\n"), {"d.csv:2", "never closed"}), 3);
  EXPECT_EQ(refused(table("a,word\n2,x\n1,x\n\n2k,x\n2000,x\n"), {"d.csv:6", "run of line 5 again"}), 3);
  EXPECT_EQ(refused(table("a,seed\n1,2\n1,3\n1,2\n"), {"d.csv:4", "run of line 2 again, with its seed"}), 3);
  DesignRequest request = table("a,seed\n1,2\n");
  request.repeat = 2;
  EXPECT_EQ(refused(request, {"--repeat"}), 2);
  request.repeat = 1;
  request.random = {"2", "b=0..1"};
  EXPECT_EQ(refused(request, {"--random"}), 2);
}

TEST(Design, RefusesABillionRunsWithTheirCount) {
  DesignRequest request;
  std::string values = "b=0";
  for (int i = 1; i < 1000; ++i) values += "," + std::to_string(i);
  request.vary = {values};
  request.repeat = 1'000'000;
  EXPECT_EQ(refused(request, {"1000000000 runs"}), 2);
  request.repeat = ~std::uint64_t{0};
  EXPECT_EQ(refused(request, {"18446744073709551616000 runs"}), 2) << "a product that does not fit 64 bits";
}

}  // namespace
}  // namespace verisim::batch::design_test
