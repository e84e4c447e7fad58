// Devices, filters, grasps, bindings.
#include <gtest/gtest.h>

#include "tests/script/written_scenario.hpp"

namespace verisim::device_words_test {
namespace {

constexpr const char* kTrace = R"(# verisim-trace 1
# kind: haptic
# rate_hz: 20
# source: written by a test
t,px,py,pz,qx,qy,qz,qw,button
5.00,0,0,0,0,0,0,1,0
5.05,0.1,0,0,0,0,0,1,1
5.10,0.2,0,0,0,0,0,1,1
)";

TEST(Devices, AreNamedByTheirInnermostPart) {
  WrittenScenario written(R"(
    local omni = Devices.Sensable.PhantomOmni{ name = "Omni1", forces = true, scale = 4 }
    addDevice(translateDevice{ omni, translation = {0, 1, -0.5} })
    addManipulator(Devices.Haption.Virtuose6D3545{ ipaddress = "192.168.1.1" })
    addDevice(Devices.Hand{ path = {{0, 0, 0}, {1, 0, 0}} })
    addDevice(Devices.Hand{ path = {{position = {0, 0, 0}}} })
    assert(omni.name == "Omni1"))");
  const Scene& scene = written.build();
  ASSERT_EQ(scene.devices.size(), 4u);
  EXPECT_EQ(scene.devices[0]->name(), "Omni1");
  EXPECT_EQ(scene.devices[1]->name(), "virtuose");
  EXPECT_EQ(scene.devices[2]->name(), "hand");
  EXPECT_EQ(scene.devices[3]->name(), "hand2");
  EXPECT_FALSE(scene.devices[0]->driven());
}

// 0.1 m of the trace, times the Omni's scale, plus the translation; its time begins at 0.
TEST(Bind, DrivesHardwareThroughItsFilters) {
  WrittenScenario written(R"(
    addDevice(translateDevice{ Devices.Sensable.PhantomOmni{ name = "omni", scale = 4 }, translation = {0, 1, 0} }))");
  written.write("hand.csv", kTrace);
  written.options.binds = {{"omni", "hand.csv"}};
  Simulation& simulation = written.run(50);
  (void)simulation;
  const DeviceReading& reading = written.scene.devices[0]->reading();
  EXPECT_TRUE(written.scene.devices[0]->driven());
  EXPECT_NEAR(reading.handle.position.x(), 4 * 0.1, 4 * 0.0025);  // one frame is 2 mm of the trace, plus resolution
  EXPECT_NEAR(reading.handle.position.y(), 1, 1e-12);
}

TEST(Bind, OfAnUnknownOrDrivenDeviceIsRefused) {
  WrittenScenario unknown("addDevice(Devices.Sensable.PhantomOmni{ name = 'omni' })");
  unknown.write("hand.csv", kTrace);
  unknown.options.binds = {{"omi", "hand.csv"}};
  EXPECT_EQ(unknown.refusal(), "--bind omi=hand.csv: pin.lua has no device 'omi'; did you mean 'omni'? (omni)");
  WrittenScenario driven("addDevice(Devices.Replay{ name = 'replay', trace = 'hand.csv' })");
  driven.write("hand.csv", kTrace);
  driven.options.binds = {{"replay", "hand.csv"}};
  EXPECT_NE(driven.refusal().find("is driven by the scenario itself"), std::string::npos);
  WrittenScenario operated(
      "addDevice(Devices.Sensable.PhantomOmni{ name = 'omni', operator = Devices.Replay{ trace = 'hand.csv' } })");
  operated.write("hand.csv", kTrace);
  operated.options.binds = {{"omni", "hand.csv"}};
  EXPECT_EQ(operated.refusal(),
            "--bind omni=hand.csv: device 'omni' is driven already by the scenario; drop the --bind or the scenario's "
            "source");
  WrittenScenario missing("addDevice(Devices.Sensable.PhantomOmni{ name = 'omni' })");
  missing.options.binds = {{"omni", "gone.csv"}};
  EXPECT_EQ(missing.refusal().rfind("--bind omni=gone.csv: gone.csv: ", 0), 0u);
}

TEST(Replay, ReadsItsTraceWithItsButton) {
  WrittenScenario written(R"(
    replay = Devices.Replay{ name = "r", trace = "hand.csv" }
    addDevice(replay)
    assert(replay:getButtonState(0) == false)
    Actions.addFrameAction(function()
      while true do
        measure("x", replay.position:x(), "m")
        measure("button", replay:getButtonState(0) and 1 or 0)
        Actions.waitForRedraw()
      end
    end))");
  written.write("hand.csv", kTrace);
  written.run(17);  // the first script frame: the trace is at 0.016 s, the button not yet down
  ASSERT_EQ(written.scenario->measures().size(), 2u);
  EXPECT_NEAR(written.scenario->measures()[0].value, 2 * 0.0165, 0.002);
  EXPECT_EQ(written.scenario->measures()[1].value, 0);
  written.run(50);
  EXPECT_EQ(written.scenario->measures()[1].value, 1);
}

TEST(Replay, RefusesGapsUnlessTheScenarioAllowsThem) {
  std::string gap = kTrace;
  gap += "6.00,0.2,0,0,0,0,0,1,1\n";
  for (const bool allowed : {false, true}) {
    WrittenScenario written(std::string("addDevice(Devices.Replay{ trace = 'hand.csv', allowGaps = ") +
                            (allowed ? "true" : "false") + " })");
    written.write("hand.csv", gap);
    EXPECT_EQ(written.refusal().empty(), allowed);
  }
}

TEST(Hand, TakesTheRunsSeedUnlessItHasItsOwn) {
  const auto x_after = [](const std::string& fields, std::uint64_t seed) {
    WrittenScenario written("addDevice(Devices.Hand{ path = {{0, 0, 0}}, tremor = 0.01" + fields + " })");
    written.options.seed = seed;
    written.options.duration = 0.1;
    written.run(100);
    return written.scene.devices[0]->reading().handle.position.x();
  };
  EXPECT_EQ(x_after("", 1), x_after("", 1));
  EXPECT_NE(x_after("", 1), x_after("", 2));
  EXPECT_EQ(x_after(", seed = 5", 1), x_after(", seed = 5", 2));
}

// Its tremor is drawn by the hardware's name or, if it has a name of its own, by its word's: whichever name that is.
TEST(Hand, ThatDrivesHardwareTremblesAlikeUnderEveryNameOfItsOwn) {
  const auto x_after = [](const std::string& fields, const std::string& hardware) {
    WrittenScenario written("addDevice(Devices.Haption.Virtuose6D3545{ name = '" + hardware +
                            "', operator = Devices.Hand{ path = {{0, 0, 0}}, tremor = 0.01" + fields + " } })");
    written.options.duration = 0.1;
    written.run(100);
    return written.scene.devices[0]->reading().handle.position.x();
  };
  EXPECT_EQ(x_after(", name = 'a'", "left"), x_after(", name = 'b'", "right"));
  EXPECT_EQ(x_after(", name = 'a'", "left"), x_after("", "hand"));
  EXPECT_NE(x_after("", "left"), x_after("", "right"));
}

TEST(Hand, RefusesAPathThatIsNone) {
  EXPECT_NE(refusal_of("Devices.Hand{}").find("needs path"), std::string::npos);
  EXPECT_NE(refusal_of("Devices.Hand{ path = {} }").find("list of waypoints"), std::string::npos);
  EXPECT_NE(refusal_of("Devices.Hand{ path = {{position = {0, 0, 0}, sped = 1}} }").find("did you mean 'speed'?"),
            std::string::npos);
  EXPECT_NE(refusal_of("Devices.Hand{ path = {{0, 0, 0}}, tremor = -1 }").find("must not be negative"),
            std::string::npos);
}

// A goal's place is the virtual world's: behind a scale of 4 the hand goes a quarter of the way. What holds a body is
// told where it is: the box was grasped 0.1 m beside the handle.
TEST(Goals, AreSoughtInTheVirtualWorldByHandleOrBody) {
  for (const bool body : {false, true}) {
    WrittenScenario written(std::string(R"(
      defineSimulationParameters{ maxStiffness = 1000 }
      local box = addObject{ name = "box", voxelsize = 0.02, position = {0, 0.1, 0}, Solid.box{0.1, 0.1, 0.1} }
      hand = Devices.Ideal{ name = "it", scale = 4, operator = Devices.Hand{ goal = "reach", to = {0.2, 0.1, 0}, watch = ")") +
                            (body ? "body" : "handle") + R"(" } }
      addDevice(hand)
      grasp(hand, box))");
    written.options.duration = 2;
    written.run(2000);
    const Vector3d& handle = written.scene.devices[0]->reading().handle.position;
    EXPECT_LE((handle - Vector3d(0.2, body ? 0 : 0.1, 0)).norm(), 0.0055);
    const std::vector<std::string> said = written.events("goal");
    ASSERT_EQ(said.size(), 2u);
    EXPECT_EQ(said[0], "it begins to reach");
    EXPECT_EQ(said[1], "it has reached its goal");
  }
}

TEST(Goals, OfTwoHandsAreRecordedUnderTheirDevices) {
  WrittenScenario written(R"(
    for _, name in ipairs{ "left", "right" } do
      addDevice(Devices.Ideal{ name = name, operator = Devices.Hand{ name = name .. " hand", arm = "drawn", goals = {
        { goal = "insert", from = {0, 0, 0.1}, to = {0, 0, 0}, strategy = "spiral", pitch = 0.001 },
        { goal = "wander", box = { min = {0, 0, 0}, max = {0.1, 0.1, 0.1} }, places = 2 },
        { goal = "touch and retreat", to = {0.1, 0, 0}, retreat = {0, 0, 0}, force = 1 },
        { goal = "withdraw", to = {position = {0, 0, 0.1}, orientation = AngleAxis(0.1, Axis{0, 0, 1})} } } } })
    end)");
  written.options.duration = 0.1;
  written.run(100);
  EXPECT_EQ(written.scene.devices.size(), 2u);  // one name for both records would have ended the program
}

TEST(Goals, RefuseWhatIsNone) {
  const auto refused = [](const std::string& fields, const std::string& wanted) {
    const std::string text = refusal_of("addDevice(Devices.Hand{ " + fields + " })");
    EXPECT_NE(text.find(wanted), std::string::npos) << fields << ": " << text;
  };
  refused("goal = 'reech', to = {0, 0, 0}", "did you mean 'reach'?");
  refused("goal = 'reach'", "needs to");
  refused("goal = 3, to = {0, 0, 0}", "goal");
  refused("goals = {}", "list of goals");
  refused("goals = {{to = {0, 0, 0}}}", "goals[1] needs goal");
  refused("goals = {{goal = 'reach', to = {0, 0, 0}, toleranse = 1}}", "did you mean 'tolerance'?");
  refused("goal = 'reach', to = {0, 0}", "to");
  refused("goal = 'reach', to = {0, 0, 0/0}", "finite");
  refused("goal = 'reach', to = {position = {0, 0, 0}, sped = 1}", "sped");
  refused("goal = 'reach', to = {0, 0, 0}, path = {{0, 0, 0}}", "both a path and goals");
  refused("goal = 'reach', to = {0, 0, 0}, goals = {{goal = 'reach', to = {0, 0, 0}}}", "both goal and goals");
  refused("goal = 'insert', to = {0, 0, 0}, strategy = 'spirale'", "did you mean 'spiral'?");
  refused("goal = 'wander'", "needs box");
  refused("goal = 'wander', box = {min = {0, 0, 0}}", "needs min and max");
  refused("goal = 'wander', box = {min = {1, 0, 0}, max = {0, 0, 0}}", "box ends before it begins");
  refused("goal = 'wander', box = {min = {0, 0, 0}, max = {0, 0, 0}}, places = -1", "must not be negative");
  refused("goal = 'wander', box = {min = {0, 0, 0}, max = {0, 0, 0}}, places = 2.5", "must be a whole number");
  refused("goal = 'wander', box = {min = {0, 0, 0}, max = {0, 0, 0}}, places = 1e10", "must be a whole number");
  refused("goal = 'touch and retreat', to = {0, 0, 0}", "needs retreat");
  refused("goal = 'reach', to = {0, 0, 0}, watch = 'eye'", "handle");
  refused("goal = 'reach', to = {0, 0, 0}, arm = 'published'", "measured");
  refused("goal = 'reach', to = {0, 0, 0}, arm = 'drawn', mass = 1", "leave one of them out");
  for (const char* field : {"tolerance", "angularTolerance", "speed", "giveUp", "reach", "push", "greatestForce"})
    for (const char* bad : {"0", "-1", "0/0"})
      refused(std::string("goal = 'reach', to = {0, 0, 0}, ") + field + " = " + bad, field);
  for (const char* field : {"pitch", "searchSpeed", "searchRadius", "tilt", "press"})
    for (const char* bad : {"0", "-1", "0/0"})
      refused(std::string("goal = 'insert', to = {0, 0, 0}, ") + field + " = " + bad, field);
  for (const char* field : {"dwell", "reaction"})
    refused(std::string("goal = 'reach', to = {0, 0, 0}, ") + field + " = -1", field);
}

TEST(Grasp, NamesTheChainThatHoldsTheDevice) {
  WrittenScenario written(R"(
    local omni = Devices.Sensable.PhantomOmni{ operator = Devices.Hand{ path = {{0, 0, 0}} } }
    addDevice(Devices.Hand{ path = {{0, 0, 0}} })
    addDevice(translateDevice{ omni, translation = {0, 0, 1} })
    grasp(omni, addObject{ voxelsize = 0.1, Solid.box{1, 1, 1} }))");
  const Scene& scene = written.build();
  ASSERT_EQ(scene.grasps.size(), 1u);
  EXPECT_EQ(scene.grasps[0].device, 1u);
  EXPECT_EQ(scene.grasps[0].body, 0u);
}

TEST(Grasp, OfADeviceThatWasNeverAddedIsRefused) {
  EXPECT_EQ(refusal_of("local hand = Devices.Hand{ path = {{0, 0, 0}} }\n"
                       "grasp(hand, addObject{ voxelsize = 0.1, Solid.box{1, 1, 1} })"),
            "pin.lua:1: this device grasps a body but was never added; call addDevice(device) first");
}

TEST(Filters, AreNotStackedWithoutEnd) {
  EXPECT_NE(
      refusal_of("local d = Devices.Hand{ path = {{0, 0, 0}} } for i = 1, 1e5 do d = scaleDevice{ d, scale = 2 } end")
          .find("100 filters"),
      std::string::npos);
}

TEST(AddDevice, RefusesADeviceTwice) {
  EXPECT_NE(
      refusal_of("local d = Devices.Hand{ path = {{0, 0, 0}} } addDevice(d) addDevice(scaleDevice{ d, scale = 2 })")
          .find("added already"),
      std::string::npos);
  EXPECT_NE(refusal_of("for i = 1, 2 do addDevice(Devices.Hand{ name = 'h', path = {{0, 0, 0}} }) end").find("already"),
            std::string::npos);
}

}  // namespace
}  // namespace verisim::device_words_test
