// The same figures stand in scenarios/iso286.lua: the script is asked for every zone and every row.
#include "engine/batch/iso286.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "engine/script/scenario.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/paths.hpp"

namespace verisim::batch::iso286_test {
namespace {

/// Measures of a scenario that asks iso286.lua about one fit.
std::vector<Measure> limits_of(const std::string& folder, const std::string& hole, const std::string& shaft) {
  std::ofstream(folder + "/fit.lua") << "local limits = require 'iso286'\n"
                                        "for _, mm in ipairs{3.5, 6, 8, 15, 25, 40, 60, 70, 90, 120} do\n"
                                        "  local a, b, c, d = limits('" +
                                            hole + "/" + shaft +
                                            "', mm / 1000)\n"
                                            "  measure(mm .. ' 1', a) measure(mm .. ' 2', b)\n"
                                            "  measure(mm .. ' 3', c) measure(mm .. ' 4', d)\n"
                                            "end\n";
  Inputs inputs = Inputs::live(folder, {});
  return Scenario({.path = folder + "/fit.lua", .sets = {}, .binds = {}, .seed = {}, .duration = {}}, inputs)
      .measures();
}

TEST(Iso286, IsTheTableOfTheScenarios) {
  const test::Folder folder;
  std::filesystem::copy_file(paths::in_sources("scenarios/iso286.lua"), folder.path().string() + "/iso286.lua");
  const std::vector<std::string> shafts = {"d", "e", "f", "g", "h", "js", "k", "m", "n", "p", "r", "s"};
  const std::vector<std::string> holes = {"D", "E", "F", "G", "H", "JS"};
  const std::vector<double> sizes = {3.5, 6, 8, 15, 25, 40, 60, 70, 90, 120};
  for (int grade = 5; grade <= 11; ++grade)
    for (std::size_t i = 0; i < shafts.size(); ++i) {
      const std::string hole = holes[i % holes.size()] + std::to_string(grade),
                        shaft = shafts[i] + std::to_string(grade);
      const std::vector<Measure> said = limits_of(folder.path().string(), hole, shaft);
      ASSERT_EQ(said.size(), 4 * sizes.size());
      for (std::size_t s = 0; s < sizes.size(); ++s) {
        const Deviations h = deviations("x", hole, sizes[s] / 1000), g = deviations("x", shaft, sizes[s] / 1000);
        SCOPED_TRACE(hole + "/" + shaft + " at " + std::to_string(sizes[s]));
        EXPECT_DOUBLE_EQ(h.lower, said[4 * s].value);
        EXPECT_DOUBLE_EQ(h.upper, said[4 * s + 1].value);
        EXPECT_DOUBLE_EQ(g.lower, said[4 * s + 2].value);
        EXPECT_DOUBLE_EQ(g.upper, said[4 * s + 3].value);
      }
    }
}

}  // namespace
}  // namespace verisim::batch::iso286_test
