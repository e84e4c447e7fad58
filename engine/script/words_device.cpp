// Devices and grasps.
#include "engine/device/hardware.hpp"
#include "engine/device/mobile_base.hpp"
#include "engine/record/trace.hpp"
#include "engine/script/device_node.hpp"
#include "engine/script/robot_node.hpp"
#include "engine/script/script_state.hpp"
#include "engine/script/values.hpp"

namespace verisim::script {

namespace {

constexpr double kOmniScale = 20;     // SPARTA's default for the Phantom Omni
constexpr double kVirtuoseScale = 1;  // and for the Virtuose

// --- hardware -------------------------------------------------------------------------------------------------------

/// What of a model a scene may switch off, on, or set.
void read_hardware(Fields& fields, HardwareDescription& d) {
  d.forces = fields.boolean("forces").value_or(d.forces);
  d.resolution = fields.not_negative("resolution", d.resolution);
  d.force_max = fields.positive("peakForce").value_or(d.force_max);
  d.torque_max = fields.not_negative("peakTorque", d.torque_max);
  d.stops = fields.boolean("stops").value_or(d.stops);
  d.rate = fields.not_negative("rate", d.rate);
  d.delay = fields.not_negative("delay", d.delay);
  d.load.mass = fields.not_negative("mass", d.load.mass);
  d.load.friction = fields.not_negative("friction", d.load.friction);
}

/// base = robot: who drives the device by operator= walks in the room. What --bind brings was recorded at the device.
void read_base(lua_State* L, Fields& fields, DeviceNode& node, const char* word) {
  if (!fields.push("base")) return;
  const RobotPointer robot = get<RobotPointer>(L, lua_gettop(L), fields.name_of("base"));
  lua_pop(L, 1);
  if (!node.inner) {
    ScriptState::of(L).notice(
        fmt::format("{}: {}: base changes nothing without an operator: what is bound was "
                    "recorded at the device itself",
                    where(L), word));
    return;
  }
  node.inner->make = [make = node.inner->make, robot, &inputs = ScriptState::of(L).inputs](const DeviceMaking& making) {
    return make_mounted(make(making), robot->base_of(inputs, making.seed));
  };
}

int hardware(lua_State* L, const char* word, HardwareDescription description, double scale,
             std::initializer_list<const char*> without_effect) {
  check_building(L, word);
  Fields fields(L, 1, word);
  DevicePointer node = new_device(L, fields, description.name.c_str());
  node->drivable = true;
  read_hardware(fields, description);
  scale = fields.positive("scale").value_or(scale);
  if (fields.push("operator")) {
    node->inner = device_at(L, lua_gettop(L), fields.name_of("operator"));
    if (!node->inner->is_source())
      raise(L, "{}: operator must be a source of motion, such as Devices.Hand or Devices.Replay", word);
    lua_pop(L, 1);
  }
  read_base(L, fields, *node, word);
  for (const char* name : without_effect)
    if (fields.accepted(name))
      ScriptState::of(L).notice(fmt::format("{}: {}: {} is accepted and changes nothing", where(L), word, name));
  fields.finish(false);
  node->make = [description = std::move(description)](const DeviceMaking& making) {
    HardwareDescription named = description;
    named.name = making.name;
    return make_hardware(std::move(named), making.inner);
  };
  push(L, scaled_device(L, std::move(node), scale));
  return 1;
}

int phantom(lua_State* L) {
  return hardware(L, "Devices.Sensable.PhantomOmni", phantom_omni("omni"), kOmniScale, {});
}

int virtuose(lua_State* L) {
  return hardware(L, "Devices.Haption.Virtuose6D3545", virtuose_6d("virtuose"), kVirtuoseScale,
                  {"ipaddress", "hardwareForceScale", "torqueScale", "indexType"});
}

int touch(lua_State* L) {
  return hardware(L, "Devices.Geomagic.Touch", geomagic_touch("touch"), kOmniScale, {});
}

int ideal(lua_State* L) {
  return hardware(L, "Devices.Ideal", ideal_device("ideal"), 1, {});
}

/// What a VR system tracks in a hand: it moves things and renders nothing.
HardwareDescription tracked(const char* name) {
  HardwareDescription description = ideal_device(name);
  description.model = name;
  description.forces = false;
  return description;
}

int wand(lua_State* L) {
  return hardware(L, "Devices.Gadgeteer.Wand", tracked("wand"), 1, {"position"});
}

int glove(lua_State* L) {
  return hardware(L, "Devices.Gadgeteer.Glove", tracked("glove"), 1,
                  {"position", "options", "hardware", "reportType", "calibFile"});
}

// --- sources --------------------------------------------------------------------------------------------------------

int replay(lua_State* L) {
  check_building(L, "Devices.Replay");
  Fields fields(L, 1, "Devices.Replay");
  DevicePointer node = new_device(L, fields, "replay");
  const auto trace = fields.text("trace");
  if (!trace) raise(L, "Devices.Replay needs trace: Devices.Replay{{ trace = \"hand.csv\" }}");
  const double max_gap = fields.positive("maxGap").value_or(TraceLimits{}.max_gap);
  const bool allow_gaps = fields.boolean("allowGaps").value_or(false);
  fields.finish(false);
  node->make = replay_of(ScriptState::of(L).inputs, *trace, max_gap, allow_gaps);
  push(L, node);
  return 1;
}

// --- the scene --------------------------------------------------------------------------------------------------

int add_device(lua_State* L) {
  check_building(L, "addDevice");
  ScriptState& state = ScriptState::of(L);
  DevicePointer device = device_at(L, 1, "addDevice: the device");
  Sandbox::charge(L, 1000 + 100 * state.devices.size());
  for (const DevicePointer& known : state.devices)
    for (const DeviceNode* a = known.get(); a != nullptr; a = a->inner.get())
      for (const DeviceNode* b = device.get(); b != nullptr; b = b->inner.get())
        if (a == b) raise(L, "addDevice: this device, or one inside it, was added already; add the outermost, once");
  state.devices.push_back(std::move(device));
  lua_settop(L, 1);
  return 1;
}

int grasp(lua_State* L) {
  ScriptState& state = ScriptState::of(L);
  DevicePointer device = device_at(L, 1, "grasp: the first argument");
  const std::size_t body = get<BodyHandle>(L, 2, "grasp: the second argument").index;
  if (state.described_body(body).fixed)
    raise(L, "grasp: '{}' is fixed and cannot be held", state.described_body(body).name);
  if (state.simulation != nullptr)
    state.simulation->grasp(state.device_index(*device), body);
  else
    state.grasps.emplace_back(std::move(device), body);
  return 0;
}

int release(lua_State* L) {
  ScriptState& state = ScriptState::of(L);
  const DevicePointer device = device_at(L, 1, "release: the device");
  if (state.simulation == nullptr) raise(L, "release: the simulation does not run yet");
  state.simulation->release(state.device_index(*device));
  return 0;
}

// --- what a running device says -------------------------------------------------------------------------------------

// A device that was made and never added has no state.
Device* running(lua_State* L, const DeviceNode& node) {
  return ScriptState::of(L).simulation == nullptr ? nullptr : node.device.get();
}

int button_state(lua_State* L) {
  const DevicePointer node = device_at(L, 1, "getButtonState: the device");
  const double index = lua_isnoneornil(L, 2) ? 0 : number_at(L, 2, "getButtonState: the button");
  const Device* device = running(L, *node);
  lua_pushboolean(L, device != nullptr && index == 0 && device->reading().button ? 1 : 0);
  return 1;
}

/// The values that start at `at`, as numbers.
std::vector<double> values_of(const Column& column, const std::byte* at) {
  std::vector<double> values(column.width);
  for (std::size_t i = 0; i < column.width; ++i) {
    const std::byte* from = at + i * size_of(column.dtype);
    const auto as = [&]<typename T>(T value) {
      std::memcpy(&value, from, sizeof value);
      return static_cast<double>(value);
    };
    values[i] = column.dtype == Dtype::f64   ? as(double{})
                : column.dtype == Dtype::u64 ? as(std::uint64_t{})
                : column.dtype == Dtype::u32 ? as(std::uint32_t{})
                                             : as(std::uint8_t{});
  }
  return values;
}

/// device:recorded("outside"): what the device itself records, now. A number or a list.
int recorded(lua_State* L) {
  const DevicePointer node = device_at(L, 1, "recorded: the device");
  const std::string name = text_at(L, 2, "recorded: the name");
  const Device* device = running(L, *node);
  if (device == nullptr) raise(L, "recorded: a device records nothing before the simulation runs");
  if (!node->recorded) {
    node->recorded = std::make_unique<Columns>();
    device->declare(*node->recorded);
  }
  const Columns& columns = *node->recorded;
  std::vector<std::byte> row(columns.state_bytes());
  columns.put_state(row.data());
  std::vector<std::string> known;
  std::size_t offset = 0;
  for (const Column& column : columns.state()) {
    known.push_back(column.path.substr(column.path.rfind('/') + 1));
    if (known.back() == name) {
      const std::vector<double> values = values_of(column, row.data() + offset);
      if (values.size() == 1) return lua_pushnumber(L, values[0]), 1;
      lua_createtable(L, static_cast<int>(values.size()), 0);
      for (std::size_t i = 0; i < values.size(); ++i) {
        lua_pushnumber(L, values[i]);
        lua_rawseti(L, -2, static_cast<int>(i + 1));
      }
      return 1;
    }
    offset += column.bytes();
  }
  raise(L, "device '{}' records no '{}'{}", device->name(), name, suggestion(name, known));
}

int device_member(lua_State* L) {
  const DevicePointer node = device_at(L, 1, "what a device's word is called on");
  const std::string name = text_at(L, 2, "a device's member");
  const Device* device = running(L, *node);
  const DeviceReading reading = device != nullptr ? device->reading() : DeviceReading{};
  const Wrench rendered = device != nullptr ? device->rendered() : Wrench{};
  if (name == "name")
    push_text(L, innermost(*node).name);
  else if (name == "handle" || name == "pose")
    push(L, Pose(reading.handle));
  else if (name == "raw")
    push(L, Pose(reading.raw));
  else if (name == "position")
    push(L, Vector3d(reading.handle.position));
  else if (name == "orientation")
    push(L, Quaterniond(reading.handle.rotation));
  else if (name == "matrix")
    push_matrix_of(L, reading.handle);
  else if (name == "forces")
    push(L, Vector3d(rendered.force));
  else if (name == "torques")
    push(L, Vector3d(rendered.torque));
  else if (name == "gain" && node->gain)
    lua_pushnumber(L, *node->gain);
  else if (name == "getButtonState")
    push_function<button_state, Charge::call>(L);
  else if (name == "recorded")
    push_function<recorded, Charge::call>(L);
  else
    raise(L, "a device has no '{}'{}", name,
          suggestion(name, {"name", "handle", "pose", "raw", "position", "orientation", "matrix", "forces", "torques",
                            "getButtonState", "recorded"}));
  return 1;
}

/// Of what drives a base, the gain; of all else nothing.
int set_device_member(lua_State* L) {
  const DevicePointer node = device_at(L, 1, "a device");
  const bool has_name = lua_type(L, 2) == LUA_TSTRING;
  if (!has_name || !node->gain || text_at(L, 2, "a device's member") != "gain") return refuse_assignment(L);
  *node->gain = number_at(L, 3, "a device's gain");
  return 0;
}

/// While it runs, its whole chain.
int device_text(lua_State* L) {
  const DevicePointer node = device_at(L, 1, "a device");
  const Device* device = running(L, *node);
  push_text(L, device != nullptr ? device->described() : fmt::format("device '{}'", innermost(*node).name));
  return 1;
}

}  // namespace

void add_device_words(lua_State* L) {
  push_metatable<DevicePointer>(L);
  set_function<device_member, Charge::call>(L, "__index");
  set_function<set_device_member, Charge::call>(L, "__newindex");
  set_function<device_text, Charge::call>(L, "__tostring");
  lua_pop(L, 1);
  lua_newtable(L);
  lua_newtable(L);
  set_function<phantom, Charge::call>(L, "PhantomOmni");
  lua_setfield(L, -2, "Sensable");
  lua_newtable(L);
  set_function<virtuose, Charge::call>(L, "Virtuose6D3545");
  lua_setfield(L, -2, "Haption");
  lua_newtable(L);
  set_function<touch, Charge::call>(L, "Touch");
  lua_setfield(L, -2, "Geomagic");
  lua_newtable(L);
  set_function<wand, Charge::call>(L, "Wand");
  set_function<glove, Charge::call>(L, "Glove");
  lua_setfield(L, -2, "Gadgeteer");
  set_function<ideal, Charge::call>(L, "Ideal");
  set_function<replay, Charge::call>(L, "Replay");
  add_hand_word(L);
  lua_setglobal(L, "Devices");
  set_global<add_device, Charge::call>(L, "addDevice");
  set_global<grasp, Charge::call>(L, "grasp");
  set_global<release, Charge::call>(L, "release");
  // SPARTA's word before its version 3.
  set_global<add_device, Charge::call>(L, "addManipulator");
}

}  // namespace verisim::script
