// The doors of engine/script. A scenario cannot break them: whatever it does wrong is an error with its line.
#include <gtest/gtest.h>

#include <limits>

#include "engine/script/assembly_node.hpp"
#include "engine/script/device_node.hpp"
#include "engine/script/lua_pattern.hpp"
#include "engine/script/script_state.hpp"
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
  EXPECT_BROKEN(written.scenario->attach(simulation), "simulation == nullptr");
}

TEST(ScenarioDeathTest, IsAttachedToTheSimulationOfItsScene) {
  WrittenScenario written("addObject{ name = 'box', density = 1000, Solid.box{0.02, 0.02, 0.02} }");
  Scene scene = written.build();
  scene.bodies.push_back(scene.bodies[0]);
  scene.bodies[1].name = "another";
  Simulation more(scene, {});
  EXPECT_BROKEN(written.scenario->attach(more), "running.body_count() == scene.bodies.size()");
  scene.bodies.pop_back();
  scene.parameters.timestep = 0.002;
  Simulation slower(scene, {});
  EXPECT_BROKEN(written.scenario->attach(slower), "running.dt() == scene.parameters.timestep");
}

/// A script's state without a simulation, as its words see it.
struct BareState {
  WrittenScenario written{"addObject{ name = 'box', density = 1000, Solid.box{0.02, 0.02, 0.02} }"};
  std::unique_ptr<Inputs> inputs = std::make_unique<Inputs>(Inputs::live(written.folder().string(), {}));
  ScriptState state{written.options, *inputs};
};

TEST(ScriptStateDeathTest, TakesEventsCompanionsAndBodiesThatAre) {
  BareState bare;
  ScriptState& state = bare.state;
  EXPECT_BROKEN(state.event("", "text"), "!kind.empty()");
  EXPECT_BROKEN(state.add_companion(state.lua(), nullptr), "node != nullptr");
  EXPECT_BROKEN(state.described_body(0), "body < scene.bodies.size()");
  struct Nobody : CompanionNode {
    void bind(const std::string&) override {}
    [[nodiscard]] std::shared_ptr<Companion> make(Inputs&, std::uint64_t) override { return nullptr; }
  };
  state.companions.push_back(std::make_shared<Nobody>());
  EXPECT_BROKEN(state.finish(), "scene.companions.back() != nullptr");
  state.companions.clear();
  state.masses = {1};
  EXPECT_BROKEN(state.finish(), "masses.size() == scene.bodies.size()");
  state.masses.clear();
  state.scene.companions.push_back(nullptr);
  EXPECT_BROKEN(state.finish(), "scene.devices.empty() && scene.companions.empty() && scene.grasps.empty()");
}

TEST(FrameActionsDeathTest, AreFunctionsInFramesThatLast) {
  BareState bare;
  FrameActions& actions = bare.state.actions;
  lua_pushnumber(bare.state.lua(), 1);
  EXPECT_BROKEN(actions.add(bare.state.lua(), -1), "lua_isfunction(L, index)");
  EXPECT_BROKEN(actions.update(0), "is_positive(rate)");
}

TEST(DeviceNodeDeathTest, IsAChainWithAMakerAtEachLink) {
  BareState bare;
  lua_State* L = bare.state.lua();
  DeviceNode node;
  EXPECT_BROKEN(innermost(node), "at->inner != nullptr");
  EXPECT_BROKEN(new_filter(L, nullptr), "inner != nullptr");
  EXPECT_BROKEN(replay_of(*bare.inputs, "hand.csv", 0, false), "max_gap > 0");
  lua_settop(L, 0);
  lua_newtable(L);
  Fields fields(L, 1, "Devices.Hand");
  EXPECT_BROKEN(new_device(L, fields, ""), "*default_name != '\\0'");
  node.default_name = "hand";
  EXPECT_BROKEN(make_device(node, 1), "node.make != nullptr");
  node.make = [](const DeviceMaking&) { return std::shared_ptr<Device>(); };
  EXPECT_BROKEN(make_device(node, 1), "!innermost(node).made_as.empty()");
  node.made_as = "hand";
  EXPECT_BROKEN(make_device(node, 1), "node.device != nullptr");
}

TEST(FieldsDeathTest, AreReadFromAPlaceThatStays) {
  BareSandbox sandbox;
  lua_State* L = sandbox.lua();
  lua_settop(L, 0);
  lua_newtable(L);
  EXPECT_BROKEN(Fields(L, -1, "Group"), "index > 0");
  EXPECT_BROKEN(Fields(L, 1, ""), "!word_.empty()");
  Fields fields(L, 1, "Group");
  EXPECT_BROKEN(fields.push_child(0), "i > 0");
}

TEST(SandboxDeathTest, CallsWhatIsThere) {
  BareSandbox sandbox;
  EXPECT_BROKEN(sandbox.call(sandbox.lua(), 0, 0), "function >= 1");
  EXPECT_BROKEN(sandbox.call(sandbox.lua(), -1, 0), "arguments >= 0");
  LuaFailure failure;
  EXPECT_BROKEN(sandbox.resume(sandbox.lua(), 1, failure), "arguments <= lua_gettop(thread)");
  EXPECT_BROKEN(sandbox.allow(0), "units > 0");
}

TEST(SandboxDeathTest, NumbersObjectsAndNothingElse) {
  BareSandbox sandbox;
  lua_State* L = sandbox.lua();
  lua_pushnumber(L, 1);
  EXPECT_BROKEN(sandbox.creation_order(L, -1), "block != nullptr");
  lua_pushlightuserdata(L, &sandbox);
  EXPECT_BROKEN(sandbox.shown_number(L, -1), "!lua_islightuserdata(L, index)");
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
  BareState bare;
  EXPECT_BROKEN(load_file(*bare.inputs, "part.step", 0, false), "scale > 0");
  EXPECT_BROKEN(resolve({nullptr}, *bare.inputs), "node != nullptr");
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

// Two scales of 1e-200: their product is 0, and reached the contract of scaled(); to the loader 0 would mean "as the
// file has it". Two of 1e200: infinite.
TEST(Assembly, RefusesScalesThatLeadBeyondAllNumbers) {
  for (const char* scale : {"1e-200", "1e200"}) {
    const std::string twice = fmt::format("scale = {0}, Transform{{ scale = {0}, ", scale);
    EXPECT_NE(
        refusal_of("addObject{ name = 'box', density = 1000, Transform{ " + twice + "Solid.box{0.02, 0.02, 0.02} } } }")
            .find("transforms take it beyond all numbers"),
        std::string::npos)
        << scale;
    WrittenScenario written(
        fmt::format("addObject{{ name = 'box', density = 1000, Transform{{ scale = {0}, Model{{ 'box.stl', scale = "
                    "{0} }} }} }}",
                    scale));
    written.write("box.stl", "solid box");
    EXPECT_NE(written.refusal().find("transforms take it beyond all numbers"), std::string::npos) << scale;
  }
}

// The recorder takes no event without a kind.
TEST(Events, HaveAKind) {
  WrittenScenario written("event('', 'the pin is through')");
  EXPECT_NE(written.refusal().find("the kind is an empty text"), std::string::npos) << written.refusal();
}

}  // namespace
}  // namespace verisim::script::script_contracts_test
