// Frame actions and the run buffer, with the semantics that were recorded of VR JuggLua (frame_actions.hpp says which
// defects of it are not kept).
#include <gtest/gtest.h>

#include "tests/script/written_scenario.hpp"

namespace verisim::action_words_test {
namespace {

using Texts = std::vector<std::string>;

/// What a script prints while it runs for so many script frames at 100 Hz.
Texts printed(const std::string& script, int script_frames) {
  WrittenScenario written("defineSimulationParameters{frameRate = 100}\n" + script);
  written.run(10 * script_frames);
  return written.events("print");
}

TEST(FrameActions, FirstRunAtTheNextUpdateWithDtAsArgument) {
  EXPECT_EQ(printed("Actions.addFrameAction(function(dt) print('first', dt) end) print('added')", 1),
            (Texts{"added", "first\t0.01"}));
}

TEST(FrameActions, RunInTheOrderOfAdding) {
  EXPECT_EQ(printed("for i = 1, 3 do Actions.addFrameAction(function() while true do print(i) Actions.waitForRedraw() "
                    "end end) end",
                    2),
            (Texts{"1", "2", "3", "1", "2", "3"}));
}

// Recorded: "An action added from inside an action first runs in the next frame, just ahead of its creator."
TEST(FrameActions, AddedInsideAnActionRunNextFrameAheadOfTheirCreator) {
  EXPECT_EQ(printed(R"(
    Actions.addFrameAction(function() while true do print('before') Actions.waitForRedraw() end end)
    Actions.addFrameAction(function()
      Actions.addFrameAction(function() print('added') end)
      while true do print('creator') Actions.waitForRedraw() end
    end))",
                    2),
            (Texts{"before", "creator", "before", "added", "creator"}));
}

TEST(WaitForRedraw, SumsDtOverItsFrames) {
  EXPECT_EQ(
      printed("Actions.addFrameAction(function() print(Actions.waitForRedraw(3)) print(Actions.waitForRedraw()) end)",
              6),
      (Texts{"0.03", "0.01"}));
  EXPECT_EQ(
      printed("Actions.addFrameAction(function() print(Actions.waitForRedraw(0), Actions.waitForRedraw(-1)) end)", 1),
      (Texts{"0\t0"}));
}

// Recorded: 0.025 at dt 0.01 returns 0.03; 0 and less return 0 without waiting.
TEST(WaitSeconds, WaitsWholeFrames) {
  EXPECT_EQ(
      printed("Actions.addFrameAction(function() print(Actions.waitSeconds(0.025)) print(simulation.frame) end)", 6),
      (Texts{"0.03", "40"}));
  EXPECT_EQ(printed("Actions.addFrameAction(function() print(Actions.waitSeconds(0), Actions.waitSeconds(-2)) end)", 1),
            (Texts{"0\t0"}));
}

// 60 additions of 1/60 need not make 1: frames are counted, times are not summed.
TEST(WaitSeconds, OfOneSecondAt60HzIs60Frames) {
  WrittenScenario written("Actions.addFrameAction(function() print(Actions.waitSeconds(1)) end)");
  written.run(1020);  // the first script frame is at 1/60 s, the 61st after 61/60 s
  EXPECT_EQ(written.events("print"), (Texts{"1"}));
}

TEST(Wait, OutsideAnActionIsRefusedAtTheCallersLine) {
  EXPECT_EQ(refusal_of("\nActions.waitForRedraw()"),
            "pin.lua:2: Can't call Actions.waitForRedraw from your main code, only from a frame action!");
}

TEST(FrameActions, ThatFailEndAloneAndAreLoggedWithFileAndLine) {
  WrittenScenario written(R"(
    Actions.addFrameAction(function() Actions.waitForRedraw() local x = nil + 1 end)
    Actions.addFrameAction(function() while true do print('on') Actions.waitForRedraw() end end))");
  written.run(60);
  EXPECT_EQ(written.events("script error"),
            (Texts{"pin.lua:2: attempt to perform arithmetic on a nil value (a frame action failed and was ended)"}));
  EXPECT_EQ(written.events("print").size(), 3u);
  EXPECT_EQ(written.simulation->frame(), 60u);
}

TEST(FrameActions, ThatLoopForEverEndAlone) {
  WrittenScenario written(R"(
    Actions.addFrameAction(function() while true do pcall(function() end) end end)
    Actions.addFrameAction(function() while true do print('on') Actions.waitForRedraw() end end))");
  written.run(40);
  ASSERT_EQ(written.events("script error").size(), 1u);
  EXPECT_NE(written.events("script error")[0].find("without coming to an end"), std::string::npos);
  EXPECT_EQ(written.events("print").size(), 2u);
}

TEST(FrameActions, CanBeRemovedFromOutsideAndFromInside) {
  EXPECT_EQ(printed(R"(
    local later
    Actions.addFrameAction(function() Actions.waitForRedraw() print(Actions.removeFrameAction(later)) print(Actions.removeFrameAction(later)) end)
    later = Actions.addFrameAction(function() while true do print('on') Actions.waitForRedraw() end end))",
                    4),
            (Texts{"on", "true", "false"}));
  EXPECT_EQ(printed(R"(
    local self
    self = Actions.addFrameAction(function() while true do print('on') Actions.removeFrameAction(self) Actions.waitForRedraw() end end))",
                    3),
            (Texts{"on"}));
}

TEST(FrameActions, ThatBreedAreStopped) {
  WrittenScenario written(
      "local function breed() Actions.addFrameAction(breed) Actions.addFrameAction(breed) Actions.waitSeconds(10) end "
      "Actions.addFrameAction(breed)");
  written.run(300);
  ASSERT_FALSE(written.events("script error").empty());
  EXPECT_NE(written.events("script error")[0].find("1000 frame actions already"), std::string::npos);
}

TEST(FrameActions, WorkAfterRequire) {
  EXPECT_EQ(printed("local A = require 'Actions' A.addFrameAction(function() print('runs') end)", 1), (Texts{"runs"}));
}

TEST(RunBuffer, RunsChunksInOrderBeforeTheActionsOfAFrame) {
  EXPECT_EQ(printed(R"lua(
    Actions.addFrameAction(function() print('action') end)
    runbuf:addString("print('one') runbuf:addString(\"print('next frame')\")")
    runbuf:addString("Actions.addFrameAction(function() print('same frame') end)"))lua",
                    2),
            (Texts{"one", "action", "same frame", "next frame"}));
}

TEST(RunBuffer, GoesOnAfterAChunkThatFails) {
  WrittenScenario written(
      "runbuf:addString('x = = 1') runbuf:addString('error(\"broken\")') runbuf:addString('print(1)')");
  written.run(20);
  EXPECT_EQ(written.events("script error").size(), 2u);
  EXPECT_EQ(written.events("print"), (Texts{"1"}));
}

TEST(RunBuffer, RunsAFileOfTheScenario) {
  WrittenScenario written("runbuf:addFile('later.lua')");
  written.write("later.lua", "print(getScriptFilename())");
  written.run(20);
  EXPECT_EQ(written.events("print"), (Texts{"later.lua"}));
}

TEST(Simulation, TellsTheScriptItsState) {
  WrittenScenario written(R"(
    defineSimulationParameters{ allBodiesAreDynamic = true, gravity = {0, 0, -10} }
    assert(simulation.frame == 0 and simulation.overruns == 0 and simulation.collisionFrames == 0)
    local ball = addObject{ name = "ball", voxelsize = 0.01, position = {0, 0, 0.2}, Solid.box{0.1, 0.1, 0.1} }
    local floor = addObject{ name = "floor", voxelsize = 0.01, fixed = true, position = {0, 0, -0.05}, Solid.box{0.3, 0.3, 0.1} }
    local counter = CollisionCounter(ball)
    simulation:addFrameTask(counter)
    simulation:startInSchedulerThread()
    Actions.addFrameAction(function()
      Actions.waitSeconds(0.1)
      assert(ball.velocity[3] < -0.9 and ball.position[3] < 0.2 and ball.contacts == 0)
      assert(counter:getNumVoxelCollisions() == 0)
      Actions.waitSeconds(0.4)
      assert(simulation.collisionFrames > 0 and counter:getNumVoxelCollisions() > 0)
      counter:resetCounter()
      assert(counter:getNumVoxelCollisions() == 0)
      ball:setPosition(0, 0, 2)
      local same = simulation:runFunctionWithSimulationPaused(function() return ball.position end)
      assert(same == osg.Vec3(0, 0, 2))
      ball.matrix = osg.Matrix.translate(0, 0, 3)
      assert(ball.position[3] == 3)
      ball:setHybridEnabled(false)
      print(math.floor(simulation.time * 60 + 0.5))
      simulation:stop()
    end))");
  written.run(600);
  EXPECT_EQ(written.events("script error"), Texts{});
  EXPECT_EQ(written.events("print"), (Texts{"31"}));
  EXPECT_EQ(written.events("hybrid"), (Texts{"ball off"}));
  EXPECT_TRUE(written.scenario->finished());
}

TEST(Simulation, RefusesNewObjectsWhileItRuns) {
  WrittenScenario written("Actions.addFrameAction(function() addObject{ Solid.box{1, 1, 1} } end)");
  written.run(20);
  ASSERT_EQ(written.events("script error").size(), 1u);
  EXPECT_NE(written.events("script error")[0].find("the simulation runs already"), std::string::npos);
}

}  // namespace
}  // namespace verisim::action_words_test
