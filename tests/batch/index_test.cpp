#include "engine/batch/index.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <limits>
#include <sstream>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "engine/batch/summary.hpp"
#include "tests/length.hpp"
#include "tests/support/folder.hpp"

namespace verisim::batch::index_test {
namespace {

const Layout kLayout = {.parameters = {{"clearance", "REAL", "m", "on the radius"}, {"word", "TEXT", "", ""}},
                        .figures = {{"frames", "INTEGER", "1", "frames computed"},
                                    {"outcome", "TEXT", "", "the scenario's own word"},
                                    {"max_force_N", "REAL", "N", "largest contact force"}},
                        .timing = {{"wall_s", "REAL", "s", "wall clock"}, {"answered", "INTEGER", "1", "of itself"}}};

RowHead head(std::uint64_t run) {
  return {run, 100 + run, {0.001 * static_cast<double>(run % 4 + 1), std::string(run % 2 == 0 ? "a" : "b,\"c\"")}};
}

Answer answer(std::uint64_t run) {
  Answer a;
  a.status = run % 5 == 3 ? "timeout" : "done";
  a.error = run % 5 == 3 ? "no answer within 1 s" : "";
  a.figures = {
      {"frames", std::int64_t{100}}, {"outcome", std::string("in")}, {"max_force_N", 0.1 * static_cast<double>(run)}};
  a.timing = {{"wall_s", 0.5}, {"answered", std::int64_t{run % 5 != 3}}};
  if (run % 3 != 0) a.measures = {{"depth", 0.25 * static_cast<double>(run), "m"}};
  if (run == 4) a.measures.push_back({"a late one", 1.5, "1"});
  a.inputs = {{"s.lua", "abc"}};
  return a;
}

std::string content(const std::string& path) {
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

std::string csv_of(const std::vector<std::uint64_t>& order) {
  const test::Folder folder;
  Index index(folder.path().string() + "/index.sqlite", kLayout, "1");
  for (const std::uint64_t run : order) index.add(head(run), answer(run));
  index.write_csv(folder.path().string());
  return content(folder.path().string() + "/index.csv");
}

template <typename Do>
std::string refusal(const Do& act) {
  try {
    act();
  } catch (const Error& error) {
    return fmt::format("{}: {}", error.exit_code(), error.what());
  }
  return "taken";
}

TEST(Index, GivesOneCsvHoweverTheRowsCame) {
  const std::string forward = csv_of({0, 1, 2, 3, 4, 5});
  EXPECT_EQ(forward, csv_of({5, 4, 3, 2, 1, 0}));
  EXPECT_EQ(forward, csv_of({4, 0, 5, 2, 1, 3}));
  EXPECT_EQ(forward.substr(0, forward.find('\n')),
            "run,seed,clearance,word,status,error,outcome,a late one,depth,frames,max_force_N");
  EXPECT_NE(forward.find("1,101,0.002,\"b,\"\"c\"\"\",done,,in,,0.25,100,0.1\n"), std::string::npos) << forward;
}

TEST(Index, OfShardsJoinedIsTheIndexOfTheWhole) {
  const test::Folder folder;
  std::vector<std::unique_ptr<Index>> shards;
  for (int s = 0; s < 3; ++s)
    shards.push_back(std::make_unique<Index>(folder.path().string() + fmt::format("/{}.sqlite", s), kLayout, "1"));
  for (std::uint64_t run = 0; run < 6; ++run) shards[run % 3]->add(head(run), answer(run));
  shards.clear();
  Index all(folder.path().string() + "/all.sqlite", kLayout, "1");
  for (const int s : {2, 0, 1}) all.take_over(folder.path().string() + fmt::format("/{}.sqlite", s));
  all.write_csv(folder.path().string());
  EXPECT_EQ(content(folder.path().string() + "/index.csv"), csv_of({0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(all.unit_of("depth"), "m");
  EXPECT_EQ(all.unit_of("clearance"), "m");
}

std::string schema_of(const std::string& path) {
  Database database(path, Database::Access::read);
  Statement statement = database.prepare("SELECT sql FROM sqlite_master WHERE sql IS NOT NULL ORDER BY name");
  std::string schema;
  while (statement.step()) schema += plain_text(statement.column(0)) + "\n";
  return schema;
}

TEST(Index, HasOneSchemaHoweverTheRowsCame) {
  const test::Folder folder;
  std::vector<std::string> schemas;
  for (const auto& order : {std::vector<std::uint64_t>{0, 1, 2, 3, 4, 5}, {4, 3, 5, 1, 0, 2}}) {
    const std::string path = folder.path().string() + fmt::format("/{}.sqlite", schemas.size());
    {
      Index index(path, kLayout, "1");
      for (const std::uint64_t run : order) index.add(head(run), answer(run));
      index.write_csv(folder.path().string());
      EXPECT_EQ(index.runs().size(), 6U);
    }
    schemas.push_back(schema_of(path));
  }
  EXPECT_EQ(schemas[0], schemas[1]);
  EXPECT_LT(schemas[0].find("a late one"), schemas[0].find("depth"));
}

TEST(Index, ForgetsRunsWithoutAnAnswerAndNoOthers) {
  const test::Folder folder;
  Index index(folder.path().string() + "/index.sqlite", kLayout, "1");
  for (std::uint64_t run = 0; run < 6; ++run) index.add(head(run), answer(run));
  index.forget_unanswered();
  EXPECT_EQ(index.runs(), (std::vector<std::uint64_t>{0, 1, 2, 4, 5}));
  index.add(head(3), answer(4));
  index.write_csv(folder.path().string());
  EXPECT_EQ(index.count("done"), 6U);
}

TEST(Index, RefusesARunTwiceAndStaysAsItWas) {
  const test::Folder folder;
  Index index(folder.path().string() + "/index.sqlite", kLayout, "1");
  index.add(head(1), answer(1));
  EXPECT_ANY_THROW(index.add(head(1), answer(1)));
  EXPECT_EQ(index.runs(), std::vector<std::uint64_t>{1});
}

TEST(Index, RefusesWhatAnotherVersionMade) {
  const test::Folder folder;
  const std::string path = folder.path().string() + "/index.sqlite";
  { const Index made(path, kLayout, "0.1.0"); }
  EXPECT_EQ(refusal([&] { Index(path, kLayout, "0.2.0"); }).substr(0, 3), "3: ");
  EXPECT_NE(refusal([&] { Index(path, kLayout, "0.2.0"); }).find("go on with that version"), std::string::npos);
  Database(path).run("PRAGMA user_version = 9");
  EXPECT_NE(refusal([&] { Index(path, kLayout, "0.1.0"); }).find("format 9"), std::string::npos);
}

TEST(Index, RefusesWhatIsNoIndex) {
  const test::Folder folder;
  const std::string path = folder.path().string() + "/index.sqlite";
  std::ofstream(path) << std::string(5000, 'x');
  EXPECT_EQ(refusal([&] { Index(path, kLayout, "1"); }).substr(0, 3), "3: ");
  EXPECT_EQ(refusal([&] { (void)Index::open(folder.path().string() + "/none.sqlite", "1"); }).substr(0, 3), "3: ");
  EXPECT_EQ(refusal([&] { Index("/proc/index.sqlite", kLayout, "1"); }).substr(0, 3), "5: ");
}

TEST(Index, RefusesRunsOfTwoScenariosAndUnitsThatDiffer) {
  const test::Folder folder;
  Index index(folder.path().string() + "/index.sqlite", kLayout, "1");
  index.add(head(1), answer(1));
  Answer other = answer(2);
  other.inputs["s.lua"] = "abd";
  EXPECT_NE(refusal([&] { index.add(head(2), other); }).find("s.lua: was changed"), std::string::npos);
  other = answer(2);
  other.measures = {{"depth", 1, "mm"}};
  EXPECT_NE(refusal([&] { index.add(head(2), other); }).find("unit"), std::string::npos);
  other.measures = {{"Depth", 1, "m"}};
  EXPECT_NE(refusal([&] { index.add(head(2), other); }).find("capital"), std::string::npos);
  EXPECT_EQ(index.runs(), std::vector<std::uint64_t>{1}) << "what was refused left nothing";
}

TEST(Index, TellsAMeasureFromTheColumnOfItsName) {
  const test::Folder folder;
  Index index(folder.path().string() + "/index.sqlite", kLayout, "1");
  Answer a = answer(0);
  a.measures = {{"Frames", 3, "1"}, {"run", 4, "1"}, {"word", 5, "1"}};
  index.add(head(0), a);
  EXPECT_EQ(index.measure_columns(), (std::vector<std::string>{"measure.Frames", "measure.run", "measure.word"}));
}

// INTERFACES section 5, issue 14: an index of 10^5 runs is queried in under a second.
TEST(Index, OfAHundredThousandRunsIsSummedUpWithinASecond) {
  const test::Folder folder;
  const std::string path = folder.path().string() + "/index.sqlite";
  { const Index made(path, kLayout, "1"); }
  Database database(path);
  const int runs = test::by_length(1000, 100'000, 100'000);
  database.run(fmt::format(
      "ALTER TABLE run ADD COLUMN depth REAL; WITH RECURSIVE n(i) AS (SELECT 0 UNION ALL SELECT i + 1 FROM n "
      "WHERE i + 1 < {}) INSERT INTO run SELECT i, i * 7, (i % 10) * 0.001, 'a', 'done', NULL, "
      "CASE i % 3 WHEN 0 THEN 'in' ELSE 'out' END, 100, i * 0.1, i * 0.2 FROM n",
      runs));
  database.run("INSERT INTO timing (run) SELECT run FROM run");
  double least = std::numeric_limits<double>::infinity();  // s: other programs may have the machine once, not each time
  for (int repetition = 0; repetition < 5 && least >= 1; ++repetition) {
    const auto begin = std::chrono::steady_clock::now();
    Index index(path, kLayout, "1");
    std::uint64_t seen = 0;
    index.read({"clearance", "outcome", "depth"}, [&](const std::vector<Cell>&) { ++seen; });
    Statement groups =
        database.prepare("SELECT clearance, outcome, count(*), avg(depth) FROM run GROUP BY clearance, outcome");
    int count = 0;
    while (groups.step()) ++count;
    least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    EXPECT_EQ(seen, static_cast<std::uint64_t>(runs));
    EXPECT_EQ(count, 20);
  }
  EXPECT_LT(least, 1.0);
}

}  // namespace
}  // namespace verisim::batch::index_test
