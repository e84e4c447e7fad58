// "To add a device source or filter" (engine/device/README.md, and engine/script/README.md for its word), followed
// here: a source that goes round a circle, and a filter that mirrors.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/pinned_math.hpp"
#include "engine/device/forwarding.hpp"
#include "engine/script/device_node.hpp"
#include "engine/script/script_state.hpp"

namespace verisim::script::add_a_device_test {
namespace {

// Step 1: the classes (in engine/device: a file of their own).
class Circle final : public Device {
 public:
  Circle(std::string name, double radius) : name_(std::move(name)), radius_(radius) { sample({}); }
  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] std::string described() const override { return name_ + " (a circle)"; }
  void sample(const DeviceFrame& frame) override {
    reading_.handle.position = {radius_ * pinned::cos(frame.t), radius_ * pinned::sin(frame.t), 0};
    reading_.raw = reading_.handle;
  }
  [[nodiscard]] const DeviceReading& reading() const override { return reading_; }
  void render(const Wrench& wrench, const DeviceFrame&) override { felt_ = wrench; }
  [[nodiscard]] const Wrench& rendered() const override { return felt_; }
  [[nodiscard]] double duration() const override { return 0; }
  [[nodiscard]] double travel() const override { return 2 * radius_; }
  [[nodiscard]] bool driven() const override { return true; }

 private:
  std::string name_;
  double radius_;
  DeviceReading reading_;
  Wrench felt_;
};

class Mirror final : public ForwardingDevice {
 public:
  explicit Mirror(std::shared_ptr<Device> inner) : ForwardingDevice(std::move(inner)) { mirror(); }
  void sample(const DeviceFrame& frame) override {
    ForwardingDevice::sample(frame);
    mirror();
  }
  [[nodiscard]] const DeviceReading& reading() const override { return reading_; }
  void render(const Wrench& wrench, const DeviceFrame& frame) override {
    Wrench mirrored = wrench;
    mirrored.force.x() = -wrench.force.x();
    ForwardingDevice::render(mirrored, frame);
  }

 private:
  void mirror() {
    reading_ = ForwardingDevice::reading();
    reading_.handle.position.x() = -reading_.handle.position.x();
  }
  DeviceReading reading_;
};

// Step 2: their words, one function each.
int circle(lua_State* L) {
  check_building(L, "Devices.Circle");
  Fields fields(L, 1, "Devices.Circle");
  const DevicePointer node = new_device(L, fields, "circle");
  const double radius = fields.positive("radius").value_or(0.1);
  fields.finish(false);
  node->make = [radius](const DeviceMaking& making) { return std::make_shared<Circle>(making.name, radius); };
  push(L, node);
  return 1;
}

int mirror_device(lua_State* L) {
  Fields fields(L, 1, "mirrorDevice");
  const DevicePointer node = new_filter(L, wrapped_device(L, fields, "mirrorDevice"));
  fields.finish(true);
  node->make = [](const DeviceMaking& making) { return std::make_shared<Mirror>(making.inner); };
  push(L, node);
  return 1;
}

// Step 3: their lines in add_device_words.
void add_toy_words(lua_State* L) {
  lua_getglobal(L, "Devices");
  set_function<circle, Charge::call>(L, "Circle");
  lua_pop(L, 1);
  set_global<mirror_device, Charge::call>(L, "mirrorDevice");
}

/// The scene of a script that knows the toy words too, as Scenario makes it.
Scene scene_of(const std::string& script, const std::vector<std::pair<std::string, std::string>>& binds = {}) {
  ScenarioOptions options;
  options.path = "toy.lua";
  options.binds = binds;
  Inputs inputs = Inputs::live(".", {});
  ScriptState state(options, inputs);
  lua_State* L = state.lua();
  add_toy_words(L);
  state.allow(options.instruction_limit);
  auto failure = state.load(L, "toy.lua", script);
  if (!failure) failure = state.call(L, 0, 0);
  if (failure) throw Error(ErrorKind::input, failure->text);
  state.finish();
  return state.scene;
}

std::string refusal_of(const std::string& script, const std::vector<std::pair<std::string, std::string>>& binds = {}) {
  try {
    (void)scene_of(script, binds);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

// Step 4: their test.
TEST(AddingADevice, MakesASourceThatScenariosUse) {
  const Scene scene = scene_of(R"(
    local a, b = Devices.Circle{ radius = 0.5 }, Devices.Circle{}
    addDevice(a)
    addDevice(b)
    grasp(b, addObject{ voxelsize = 0.1, Solid.box{1, 1, 1} }))");
  ASSERT_EQ(scene.devices.size(), 2u);
  EXPECT_EQ(scene.devices[0]->name(), "circle");
  EXPECT_EQ(scene.devices[1]->name(), "circle2");
  EXPECT_EQ(scene.devices[0]->reading().handle.position, Vector3d(0.5, 0, 0));
  EXPECT_EQ(scene.grasps.at(0).device, 1u);
}

// 0.5 m to the right, mirrored, then moved by 1 m: each filter around what it was given.
TEST(AddingADevice, MakesAFilterThatStacksWithTheOthers) {
  const Scene scene = scene_of(
      "addDevice(translateDevice{ mirrorDevice{ Devices.Circle{ name = 'c', radius = 0.5 } }, translation = {1, 0, 0} "
      "})");
  EXPECT_EQ(scene.devices.at(0)->name(), "c");
  EXPECT_EQ(scene.devices[0]->reading().handle.position, Vector3d(0.5, 0, 0));
  scene.devices[0]->render({{3, 2, 1}, Vector3d::Zero()}, {0, 0, 1e-3});
  EXPECT_EQ(scene.devices[0]->rendered().force, Vector3d(-3, 2, 1));
}

TEST(AddingADevice, LetsASourceDriveHardwareAndNoFilter) {
  const Scene scene =
      scene_of("addDevice(Devices.Haption.Virtuose6D3545{ name = 'arm', operator = Devices.Circle{ radius = 2 } })");
  EXPECT_TRUE(scene.devices.at(0)->driven());
  EXPECT_EQ(scene.devices[0]->travel(), 4);
  EXPECT_NE(refusal_of("Devices.Haption.Virtuose6D3545{ operator = mirrorDevice{ Devices.Circle{} } }")
                .find("operator must be a source"),
            std::string::npos);
}

TEST(AddingADevice, MakesASourceThatIsNotBound) {
  EXPECT_NE(refusal_of("addDevice(mirrorDevice{ Devices.Circle{} })", {{"circle", "hand.csv"}})
                .find("'circle' is driven by the scenario itself"),
            std::string::npos);
}

}  // namespace
}  // namespace verisim::script::add_a_device_test
