// The doors of engine/script. A scenario cannot break them: whatever it does wrong is an error with its line.
#include <gtest/gtest.h>

#include <limits>

#include "engine/script/assembly_node.hpp"
#include "engine/script/lua_pattern.hpp"
#include "tests/script/bare_sandbox.hpp"
#include "tests/script/written_scenario.hpp"
#include "tests/support/broken.hpp"

namespace verisim::script::script_contracts_test {
namespace {

TEST(ScenarioDeathTest, IsTakenOnceAndAttachedOnce) {
  WrittenScenario written("addObject{ name = 'box', density = 1000, Solid.box{0.02, 0.02, 0.02} }");
  written.build();
  EXPECT_BROKEN(written.scenario->take_scene(), "!implementation_->state.scene_taken");
  Simulation& simulation = written.run(1);
  EXPECT_BROKEN(written.scenario->attach(simulation), "implementation_->state.simulation == nullptr");
}

TEST(SandboxDeathTest, CallsWhatIsThere) {
  BareSandbox sandbox;
  EXPECT_BROKEN(sandbox.call(sandbox.lua(), 0, 0), "function >= 1");
  EXPECT_BROKEN(sandbox.call(sandbox.lua(), -1, 0), "arguments >= 0");
  LuaFailure failure;
  EXPECT_BROKEN(sandbox.resume(sandbox.lua(), 1, failure), "arguments <= lua_gettop(thread)");
}

TEST(PatternDeathTest, IsMatchedWithinItsSubject) {
  PatternMatcher matcher("abc", "b", 1000);
  EXPECT_EQ(matcher.match_at(3), -1);
  EXPECT_BROKEN(matcher.match_at(-1), "start >= 0");
  EXPECT_BROKEN(matcher.match_at(4), "start <= static_cast<std::ptrdiff_t>(subject_.size())");
}

TEST(AssemblyDeathTest, IsPlacedAndScaledByNumbers) {
  EXPECT_BROKEN(placed(Part(), {{0, 0, 0}, Quaterniond(2, 0, 0, 0)}), "is_placement(X)");
  EXPECT_BROKEN(scaled(nullptr, 2), "solid != nullptr");
  EXPECT_BROKEN(scaled(std::make_shared<const Solid>(), 0), "scale > 0");
}

// Two transforms of 1e308 m: their sum is infinite, and reached the contract of placed().
TEST(Assembly, RefusesTransformsThatLeadBeyondAllNumbers) {
  WrittenScenario written(
      "local far = {1e308, 0, 0}\n"
      "addObject{ name = 'box', density = 1000,\n"
      "  Transform{ position = far, Transform{ position = far, Solid.box{0.02, 0.02, 0.02} } },\n"
      "  Solid.box{0.02, 0.02, 0.02} }");
  EXPECT_NE(written.refusal().find("transforms take it beyond all numbers"), std::string::npos) << written.refusal();
}

// The recorder takes no event without a kind.
TEST(Events, HaveAKind) {
  WrittenScenario written("event('', 'the pin is through')");
  EXPECT_NE(written.refusal().find("the kind is an empty text"), std::string::npos) << written.refusal();
}

}  // namespace
}  // namespace verisim::script::script_contracts_test
