// Devices and grasps.
#include <cmath>

#include "engine/device/hardware.hpp"
#include "engine/device/sources.hpp"
#include "engine/record/trace.hpp"
#include "engine/script/device_node.hpp"
#include "engine/script/script_state.hpp"
#include "engine/script/values.hpp"

namespace verisim::script {

namespace {

constexpr double kOmniScale = 20;     // SPARTA's default for the Phantom Omni
constexpr double kVirtuoseScale = 1;  // and for the Virtuose

// --- hardware -------------------------------------------------------------------------------------------------------

double not_negative(lua_State* L, Fields& fields, const char* name, double otherwise) {
  const double value = fields.number(name, otherwise);
  if (value < 0) raise(L, "{} is {:g} but must not be negative", fields.name_of(name), value);
  return value;
}

/// What of a model a scene may switch off, on, or set.
void read_hardware(lua_State* L, Fields& fields, HardwareDescription& d) {
  d.forces = fields.boolean("forces").value_or(true);
  d.resolution = not_negative(L, fields, "resolution", d.resolution);
  d.force_max = fields.positive("peakForce").value_or(d.force_max);
  d.torque_max = not_negative(L, fields, "peakTorque", d.torque_max);
  d.stops = fields.boolean("stops").value_or(d.stops);
  d.rate = not_negative(L, fields, "rate", d.rate);
  d.delay = not_negative(L, fields, "delay", d.delay);
  d.load.mass = not_negative(L, fields, "mass", d.load.mass);
  d.load.friction = not_negative(L, fields, "friction", d.load.friction);
}

int hardware(lua_State* L, const char* word, HardwareDescription description, double scale,
             std::initializer_list<const char*> without_effect) {
  check_building(L, word);
  Fields fields(L, 1, word);
  DevicePointer node = new_device(L, fields, description.name.c_str());
  node->drivable = true;
  read_hardware(L, fields, description);
  scale = fields.positive("scale").value_or(scale);
  if (fields.push("operator")) {
    node->inner = device_at(L, lua_gettop(L), fields.name_of("operator"));
    if (!node->inner->is_source())
      raise(L, "{}: operator must be a source of motion, such as Devices.Hand or Devices.Replay", word);
    lua_pop(L, 1);
  }
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

HandWaypoint waypoint_at(lua_State* L, int index, const std::string& what) {
  HandWaypoint waypoint;
  Fields fields(L, index, what);
  if (const auto position = fields.vector("position"))
    waypoint.pose.position = *position;
  else if (fields.children() == 3)
    waypoint.pose.position = vector_at(L, index, what);
  else
    raise(L, "{} needs position: {{ position = {{x, y, z}}, speed = 0.1 }} or {{x, y, z}}", what);
  waypoint.pose.rotation = fields.rotation("orientation").value_or(Quaterniond::Identity());
  waypoint.speed = fields.positive("speed").value_or(waypoint.speed);
  waypoint.dwell = fields.number("dwell", 0);
  if (waypoint.dwell < 0) raise(L, "{}: dwell is {:g} s but must not be negative", what, waypoint.dwell);
  fields.finish(true);
  return waypoint;
}

void read_path(lua_State* L, Fields& fields, HandDescription& hand) {
  if (!fields.push("path"))
    raise(L, "Devices.Hand needs path: a list of waypoints {{ position = {{x, y, z}}, speed = 0.1, dwell = 0 }}");
  const int list = lua_gettop(L);
  if (lua_type(L, list) != LUA_TTABLE || lua_objlen(L, list) == 0)
    raise(L, "Devices.Hand: path must be a list of waypoints, not {}",
          lua_type(L, list) == LUA_TTABLE ? "an empty one" : described(L, list));
  const auto count = static_cast<int>(lua_objlen(L, list));
  for (int i = 1; i <= count; ++i) {
    lua_rawgeti(L, list, i);
    hand.path.push_back(waypoint_at(L, lua_gettop(L), fmt::format("Devices.Hand: path[{}]", i)));
    lua_pop(L, 1);
  }
  lua_pop(L, 1);
}

// A muscle that is given another stiffness or mass stays critically damped unless its damping is given too.
void read_impedance(lua_State* L, Fields& fields, HandDescription& hand) {
  hand.mass = fields.positive("mass").value_or(hand.mass);
  hand.stiffness = fields.positive("stiffness").value_or(hand.stiffness);
  hand.damping = not_negative(L, fields, "damping", 2 * std::sqrt(hand.stiffness * hand.mass));
  hand.inertia = fields.positive("inertia").value_or(hand.inertia);
  hand.angular_stiffness = fields.positive("angularStiffness").value_or(hand.angular_stiffness);
  hand.angular_damping =
      not_negative(L, fields, "angularDamping", 2 * std::sqrt(hand.angular_stiffness * hand.inertia));
}

int hand_device(lua_State* L) {
  check_building(L, "Devices.Hand");
  Fields fields(L, 1, "Devices.Hand");
  DevicePointer node = new_device(L, fields, "hand");
  HandDescription hand;
  read_path(L, fields, hand);
  // `repeat` is a keyword of Lua: as a key it needs ["repeat"].
  hand.repeat = fields.boolean("loop").value_or(false);
  hand.repeat = fields.boolean("repeat").value_or(hand.repeat);
  read_impedance(L, fields, hand);
  hand.lead = fields.positive("lead").value_or(hand.lead);
  hand.patience = fields.positive("patience").value_or(hand.patience);
  hand.reaction = not_negative(L, fields, "reaction", hand.reaction);
  hand.tremor = not_negative(L, fields, "tremor", 0);
  hand.angular_tremor = not_negative(L, fields, "angularTremor", 0);
  hand.error = fields.vector("error").value_or(Vector3d::Zero());
  hand.angular_error = fields.vector("angularError").value_or(Vector3d::Zero());
  const std::optional<double> seed = fields.number("seed");
  if (seed && (*seed < 0 || *seed > 0x1p53 || *seed != std::floor(*seed)))
    raise(L, "Devices.Hand: seed must be a whole number, not {:g}", *seed);
  fields.finish(false);
  node->make = [hand = std::move(hand), seed](const DeviceMaking& making) {
    HandDescription named = hand;
    named.name = making.name;
    named.seed = seed ? static_cast<std::uint64_t>(*seed) : making.seed;
    return make_hand(std::move(named));
  };
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
  else if (name == "getButtonState")
    push_function<button_state, Charge::call>(L);
  else
    raise(L, "a device has no '{}'{}", name,
          suggestion(name, {"name", "handle", "pose", "raw", "position", "orientation", "matrix", "forces", "torques",
                            "getButtonState"}));
  return 1;
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
  set_function<ideal, Charge::call>(L, "Ideal");
  set_function<replay, Charge::call>(L, "Replay");
  set_function<hand_device, Charge::call>(L, "Hand");
  lua_setglobal(L, "Devices");
  set_global<add_device, Charge::call>(L, "addDevice");
  set_global<grasp, Charge::call>(L, "grasp");
  set_global<release, Charge::call>(L, "release");
  // SPARTA's word before its version 3.
  set_global<add_device, Charge::call>(L, "addManipulator");
}

}  // namespace verisim::script
