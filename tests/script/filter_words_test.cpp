// The words of filters: the published set-ups of ORACLES section 4 by name, and what is refused.
#include <gtest/gtest.h>

#include "tests/script/written_scenario.hpp"

namespace verisim::filter_words_test {
namespace {

std::string described(const std::string& script) {
  WrittenScenario written(script);
  return written.build().devices.at(0)->described();
}

void expect_parts(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) EXPECT_NE(text.find(part), std::string::npos) << part << " in " << text;
}

TEST(Bubbles, LoadAsPublished) {
  expect_parts(described(R"(
      addDevice(BubbleTechnique{ device = Devices.Sensable.PhantomOmni{ scale = 10 }, radius = 0.45, stiffness = 50,
        bubbleVelocityScale = 7, deviceCenter = {-0.04837, 0.4352, 0.20}, showBubble = true, elasticForce = true }))"),
               {"scaled by 10", "in a bubble of 0.45 m", "scale 7", "50 N/m"});
  expect_parts(described(R"(
      local bubble = TranslationalBubble(0.15, 100, 0.5, TranslationalBubble.PeakRingVelocity)
      bubble:showBubble()
      addDevice(BubbleNav{ bubble = bubble, device = Devices.Haption.Virtuose6D3545{ ipaddress = "192.168.1.1" },
        navigator = Navigation(), deviceCenter = {0, 0.01678, 0.6}, wireframeBubble = false }))"),
               {"Virtuose 6D35-45", "in a bubble of 0.15 m (peak-ring law", "100 N/m"});
  expect_parts(described(R"(
      local nav = Navigation()
      addDevice(BubbleNav{ bubble = TranslationalBubble(0.22, 150, 1, TranslationalBubble.PeakRingVelocity),
        device = Devices.Haption.Virtuose6D3545{}, navigator = nav, deviceCenter = {0, 0, 0.55}, lockedToFloor = true })
      addDevice(nav:transformDevice(Devices.Sensable.PhantomOmni{})))"),
               {"in a bubble of 0.22 m (peak-ring law, scale 1, 150 N/m)"});
  expect_parts(described(R"(
      addDevice(BubbleTechnique{ device = Devices.Gadgeteer.Wand{ position = "VJWand" }, radius = 1, stiffness = 100,
        bubbleVelocityScale = 15, navigate = {1, 0, 1} }))"),
               {"wand (wand, no forces), in a bubble of 1 m", "scale 15"});
}

// An Omni that holds its handle 10 mm outside of a bubble of 20 mm, x 10: V = K x = 0.5 m/s for 1 s.
TEST(Bubbles, MoveWhatTheirDeviceHolds) {
  WrittenScenario written(R"(
    addDevice(BubbleTechnique{ device = Devices.Ideal{ operator = Devices.Replay{ trace = "hand.csv" }, scale = 10 },
      radius = 0.2, law = "linear", bubbleVelocityScale = 5, deviceCenter = {0, 0, 0} }))");
  written.write("hand.csv",
                "# verisim-trace 1\n# kind: haptic\n# rate_hz: 1\n# source: a test\nt,px,py,pz,qx,qy,qz,qw\n"
                "0,0.03,0,0,0,0,0,1\n");
  (void)written.run(1001);
  EXPECT_NEAR(written.scene.devices[0]->reading().handle.position.x(), 0.3 + 0.5, 1e-12);
}

// What a device records a script reads: the same numbers as the run file's.
TEST(Devices, TellAScriptWhatTheyRecord) {
  WrittenScenario written(R"(
    local dev = BubbleTechnique{ radius = 0.1, law = "linear", bubbleVelocityScale = 5, deviceCenter = {0, 0, 0},
      device = Devices.Ideal{ operator = Devices.Hand{ path = {{0.2, 0, 0}} } } }
    addDevice(dev)
    assert(not pcall(function() return dev:recorded("outside") end))
    defineSimulationParameters{ frameRate = 1000 }
    Actions.addFrameAction(function()
      Actions.waitSeconds(0.3)
      local center, moved = dev:recorded("bubble_center"), dev.handle.position - dev.raw.position
      assert(#center == 3 and math.abs(center[1] - moved[1]) < 1e-12 and center[1] > 0.1)
      assert(dev:recorded("outside") == 1 and dev:recorded("saturated") == 0)
      assert(#dev:recorded("bubble_velocity") == 3)
      local fine, text = pcall(function() return dev:recorded("bubble") end)
      assert(not fine and text:find("records no 'bubble'"))
      outcome("read")
    end))");
  (void)written.run(400);
  EXPECT_EQ(written.scenario->outcome(), "read");
}

TEST(Navigation, IsPausedByAScript) {
  WrittenScenario written(R"(
    local nav = Navigation()
    assert(nav.paused == false)
    addDevice(BubbleNav{ bubble = TranslationalBubble(0.1, 50, 5, TranslationalBubble.LinearVelocity), navigator = nav,
      device = Devices.Ideal{ operator = Devices.Hand{ path = {{0.2, 0, 0}} } } })
    Actions.addFrameAction(function()
      Actions.waitSeconds(0.5)
      nav.paused = true
      local here = nav.position
      Actions.waitSeconds(0.2)
      assert(nav.paused and here[1] > 0.2 and nav.position[1] == here[1])
      outcome("stood")
    end))");
  (void)written.run(1000);
  EXPECT_EQ(written.scenario->outcome(), "stood");
}

TEST(Filters, AreTheOnesThatTheScriptAskedFor) {
  expect_parts(described(R"(
      local dev = Devices.Geomagic.Touch{ scale = 4, rate = 500, delay = 0.002, mass = 0.05, friction = 0.1, stops = true }
      dev = rotateDevice{ dev, rotation = AngleAxis(math.pi / 2, Axis{0, 1, 0}) }
      addDevice(passivityDevice{ bumpDevice{ dev, force = 1 }, control = false }))"),
               {"Geomagic Touch, 3.3 N", "stops", "500 Hz", "0.002 s late", "0.05 kg", "friction of 0.1 N",
                "rotated by (0, 1.57", "with a bump of 1 N", "with a passivity observer"});
}

// The published call, and a base that a trace drives: a step a second late.
TEST(TrackedTransform, LoadsAsPublishedAndIsDrivenByName) {
  expect_parts(described("addDevice(TrackedTransform(Devices.Haption.Virtuose6D3545{}, 'RobotTracker', true))"),
               {"Virtuose 6D35-45", "on a base that RobotTracker (tracker, 60 Hz) follows"});
  WrittenScenario written("addDevice(TrackedTransform{ Devices.Ideal{}, tracker = 'robot', rate = 0, delay = 0.1 })");
  written.write("base.csv",
                "# verisim-trace 1\n# kind: haptic\n# rate_hz: 10\n# source: a test\nt,px,py,pz,qx,qy,qz,qw\n"
                "0,0,0,0,0,0,0,1\n0.1,1,0,0,0,0,0,1\n0.2,1,0,0,0,0,0,1\n");
  written.options.binds = {{"robot", "base.csv"}};
  (void)written.run(151);
  EXPECT_NEAR(written.scene.devices[0]->reading().handle.position.x(), 0.5, 1e-12);
}

std::string refusal(const std::string& script) {
  return WrittenScenario("local omni = Devices.Sensable.PhantomOmni{}\n" + script).refusal();
}

TEST(Filters, RefuseWhatIsNone) {
  const std::pair<const char*, const char*> cases[] = {
      {"BubbleTechnique{ device = omni, radius = 0 }", "radius"},
      {"BubbleTechnique{ device = omni, stiffness = -1 }", "stiffness"},
      {"BubbleTechnique{ device = omni, bubbleVelocityScale = 0/0 }", "bubbleVelocityScale"},
      {"BubbleTechnique{ device = omni, law = 'sextic' }", "'sextic', which is no law"},
      {"BubbleTechnique{ device = omni, radios = 1 }", "did you mean 'radius'?"},
      {"addDevice(BubbleTechnique{ device = omni, deviceCenter = {9, 0, 0} })", "outside of the device's workspace"},
      {"BubbleTechnique{ device = BubbleTechnique{ device = omni } }", "there is a bubble around this device already"},
      {"passivityDevice{ passivityDevice{ omni } }", "there is a passivity observer around this device already"},
      {"TranslationalBubble(0, 1, 1)", "the radius is 0 but must be above 0"},
      {"TranslationalBubble(1, 1, 1, 'x')", "which is no law"},
      {"BubbleNav{ device = omni, bubble = 3 }", "BubbleNav: bubble must be a TranslationalBubble"},
      {"BubbleNav{ device = omni, navigator = omni }", "BubbleNav: navigator must be a Navigation"},
      {"Navigation().speed = 1", "a navigation's 'speed' cannot be set"},
      {"rotateDevice{ omni }", "rotateDevice needs rotation"},
      {"bumpDevice{ omni, force = 0 }", "force"},
      {"Devices.Ideal{ rate = -1 }", "rate is -1 but must not be negative"},
      {"TrackedTransform{ omni }", "TrackedTransform needs a tracker"},
      {"TrackedTransform(omni)", "the tracker's name"},
      {"TrackedTransform{ omni, tracker = 'robot', rate = -1 }", "rate is -1 but must not be negative"},
      {"TrackedTransform{ omni, tracker = 'robot', delay = 0/0 }", "delay"},
      {"TrackedTransform{ omni, tracker = 'robot', operator = omni }", "operator must be a source of motion"},
      {"addDevice(TrackedTransform{ Devices.Ideal{ name = 'omni' }, tracker = 'omni' })",
       "there is a device 'omni' already"},
      {"addDevice(TrackedTransform{ TrackedTransform{ omni, tracker = 'a' }, tracker = 'a' })",
       "there is a device 'a' already"},
      {"addDevice(omni) addDevice(bumpDevice{ omni })", "was added already"},
      // No chain bites its tail: what a filter wraps is there before it, and stays.
      {"local f = bumpDevice{ omni } f.device = f", "a device's 'device' cannot be set"},
      {"local f = bumpDevice{ omni } f[1] = f", "a device's '1' cannot be set"},
      {"local f = bumpDevice{ f }", "bumpDevice: the device must be a device, not nothing"},
      {"omni.device = bumpDevice{ omni }", "a device's 'device' cannot be set"}};
  for (const auto& [script, text] : cases)
    EXPECT_NE(refusal(script).find(text), std::string::npos) << script << ": " << refusal(script);
}

}  // namespace
}  // namespace verisim::filter_words_test
