// Robot: a mobile base that carries a haptic device; VRPNRemoteBase: what drives it.
#include <algorithm>
#include <cmath>

#include "engine/base/pinned_math.hpp"
#include "engine/device/mobile_base.hpp"
#include "engine/record/trace.hpp"
#include "engine/robot/boards.hpp"
#include "engine/robot/recorded_base.hpp"
#include "engine/script/robot_node.hpp"
#include "engine/script/script_state.hpp"
#include "engine/script/values.hpp"

namespace verisim::script {
namespace {

constexpr const char* kRobotWord = "Robot";
constexpr const char* kRemoteBase = "VRPNRemoteBase";
/// Published gains are in the wire's units: mm/s for each m of error.
constexpr double kGainUnit = 1000;
constexpr double kSightClearance = 0.35;  ///< rad: the Virtuose, 0.4 m wide, at an arm's length from the eyes
constexpr double kMarginOfPull = 0.03;    ///< m: the tracker's error, and the slip while somebody pulls with 10 N

robot::EncoderSamples read_encoder_samples(Inputs& inputs, const std::string& name) {
  const Trace trace = parse_trace(name, inputs.read(name), "encoder", {});
  robot::EncoderSamples samples;
  const auto column = [&](const char* wanted) { return static_cast<std::size_t>(trace.column(wanted)); };
  const bool has_pose = trace.column("theta") >= 0;
  for (std::size_t row = 0; row < trace.rows(); ++row) {
    const auto at = [&](const char* c) { return trace.at(row, column(c)); };
    samples.t.push_back(at("t") - trace.at(0, column("t")));
    samples.counts.push_back({at("e0"), at("e1"), at("e2"), at("e3")});
    if (has_pose) samples.pose.push_back({at("x"), at("y"), at("theta")});
  }
  return samples;
}

/// F; empty until the tracker knows the head.
std::optional<std::array<double, 2>> seen_from_above(const HeadNode& node) {
  if (node.head == nullptr || !node.head->estimate().valid) return std::nullopt;
  const Vector3d p = node.head->world_pose().position;
  return std::array{p.x(), -p.z()};
}

}  // namespace

std::shared_ptr<MovingBase> RobotNode::base_of(Inputs& inputs, std::uint64_t seed) {
  if (base) return base;
  settings.name = name;
  settings.seed = seed;
  if (trace.empty()) {
    robot = std::make_shared<robot::Robot>(settings, robot::make_board(board));
    companion = robot;
    base = robot;
    if (head) robot->watch([node = head] { return seen_from_above(*node); });
  } else {
    const auto recorded = std::make_shared<robot::RecordedBase>(settings, read_encoder_samples(inputs, trace));
    companion = recorded;
    base = recorded;
  }
  return base;
}

std::shared_ptr<Companion> RobotNode::make(Inputs& inputs, std::uint64_t seed) {
  (void)base_of(inputs, seed);
  return companion;
}

namespace {

// --- Robot{ … } -----------------------------------------------------------------------------------------------------

double at_most(lua_State* L, Fields& fields, const char* name, double otherwise, double limit) {
  const double value = fields.not_negative(name, otherwise);
  if (value > limit) raise(L, "{} is {:g} but must be at most {:g}", fields.name_of(name), value, limit);
  return value;
}

void read_tracker(lua_State* L, Fields& fields, RobotNode& node) {
  if (!fields.push("tracker")) return;
  if (lua_type(L, -1) == LUA_TSTRING) {
    node.tracker = name_at(L, lua_gettop(L), fields.name_of("tracker"));
  } else {
    Fields tracker(L, lua_gettop(L), fields.name_of("tracker"));
    robot::BaseTrackerSettings& settings = node.settings.tracker;
    node.tracker = tracker.name().value_or(node.tracker);
    settings.rate = tracker.positive("rate").value_or(settings.rate);
    settings.latency = tracker.not_negative("delay", settings.latency);
    settings.sigma_position = tracker.not_negative("noise", settings.sigma_position);
    settings.sigma_yaw = tracker.not_negative("angularNoise", settings.sigma_yaw);
    settings.dropout_rate = tracker.not_negative("dropouts", settings.dropout_rate);
    settings.dropout_mean = tracker.positive("dropout").value_or(settings.dropout_mean);
    if (!tracker.boolean("predict").value_or(true)) node.settings.estimate = {.alpha = 1, .horizon = 0, .smoothing = 0};
    tracker.finish(false);
  }
  lua_pop(L, 1);
}

void read_line(lua_State* L, Fields& fields, RobotNode& node) {
  robot::SerialLineSettings& line = node.settings.line;
  line.baud = static_cast<std::uint32_t>(at_most(L, fields, "baud", line.baud, 2e6));
  line.latency = fields.not_negative("lineDelay", line.latency);
  line.loss = fields.not_negative("loss", line.loss);
  line.corruption = fields.not_negative("corruption", line.corruption);
}

void read_walls(lua_State* L, Fields& fields, RobotNode& node) {
  if (!fields.push("walls")) return;
  Fields walls(L, lua_gettop(L), fields.name_of("walls"));
  const auto min = walls.vector("min"), max = walls.vector("max");
  if (!min || !max)
    raise(L, "{} needs min and max: {{ min = {{x, y, z}}, max = {{x, y, z}} }}", fields.name_of("walls"));
  robot::WallSettings room;
  room.corners = robot::rectangle(min->x(), max->x(), -max->z(), -min->z());
  room.radius = walls.positive("radius").value_or(room.radius);
  room.margin = walls.not_negative("margin", kMarginOfPull);
  room.force_max = walls.not_negative("force", room.force_max);
  node.settings.pilot.walls = std::move(room);
  walls.finish(false);
  lua_pop(L, 1);
}

void read_head(lua_State* L, Fields& fields, RobotNode& node) {
  robot::HeadingSettings& heading = node.settings.pilot.drive.heading;
  if (!fields.boolean("holdHeading").value_or(true)) heading.p = 0;
  if (fields.push("head")) {
    node.head = get<HeadPointer>(L, lua_gettop(L), fields.name_of("head"));
    lua_pop(L, 1);
    heading.clearance = kSightClearance;
  } else if (fields.accepted("sightClearance")) {
    raise(L, "{} needs head: the WiiHead whose line of sight is kept clear", fields.name_of("sightClearance"));
  }
  heading.clearance = at_most(L, fields, "sightClearance", heading.clearance, pinned::kPi / 2);
}

void read_place(lua_State* L, Fields& fields, RobotNode& node) {
  const Vector3d p = fields.vector("position").value_or(Vector3d::Zero());
  if (p.y() != 0) raise(L, "{} has a y of {:g} m but the floor is y = 0", fields.name_of("position"), p.y());
  node.settings.start = {p.x(), -p.z(), fields.number("heading", 0)};
  node.settings.pilot.drive.heading.desired = node.settings.start.theta;
  const Vector3d B = fields.vector("device").value_or(Vector3d(0, node.settings.device.z(), 0));
  node.settings.device = {B.x(), -B.z(), B.y()};
}

int robot_word(lua_State* L) {
  check_building(L, kRobotWord);
  ScriptState& state = ScriptState::of(L);
  Sandbox::charge(L, 1000 + 100 * state.companions.size());
  state.keep(100'000);  // lines, tracker, board
  Fields fields(L, 1, kRobotWord);
  auto node = std::make_shared<RobotNode>();
  node->word = kRobotWord;
  node->place = where(L);
  node->name = fields.name().value_or("robot");
  node->tracker = node->name + "Tracker";
  node->server = fields.text("server").value_or(node->server);
  node->board = fields.text("board").value_or(node->board);
  if (node->board != "host" && node->board != "avr")
    raise(L, "{}: board is '{}'{}", kRobotWord, node->board, suggestion(node->board, {"host", "avr"}));
  read_place(L, fields, *node);
  robot::RobotSettings& settings = node->settings;
  settings.pilot.server.gain = fields.not_negative("gain", kGainUnit * settings.pilot.server.gain) / kGainUnit;
  settings.plant.supply.voltage = fields.positive("supply").value_or(settings.plant.supply.voltage);
  settings.plant.body.mass = fields.positive("mass").value_or(settings.plant.body.mass);
  read_line(L, fields, *node);
  read_tracker(L, fields, *node);
  read_head(L, fields, *node);
  read_walls(L, fields, *node);
  fields.finish(false);
  state.add_companion(L, node);
  push(L, node);
  return 1;
}

// --- what a running robot says and takes ----------------------------------------------------------------------------

robot::Robot& running(lua_State* L, const RobotNode& node, const char* what) {
  if (ScriptState::of(L).simulation == nullptr) raise(L, "{}: the simulation does not run yet", what);
  if (node.robot == nullptr) raise(L, "{}: a trace moves robot '{}'; there is nothing to act on", what, node.name);
  return *node.robot;
}

std::size_t wheel_at(lua_State* L, int index, const char* what) {
  static constexpr std::array kNames = {"front left", "front right", "rear left", "rear right"};
  const std::string name = text_at(L, index, what);
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (name == kNames[i]) return i;
  raise(L, "{}: wheel is '{}'{}", what, name, suggestion(name, {kNames.begin(), kNames.end()}));
}

int kill_server(lua_State* L) {
  running(L, *get<RobotPointer>(L, 1, "killServer: the robot"), "killServer").pilot().kill();
  return 0;
}

int start_server(lua_State* L) {
  running(L, *get<RobotPointer>(L, 1, "startServer: the robot"), "startServer").pilot().start();
  return 0;
}

int set_gain(lua_State* L) {
  const double gain = number_at(L, 2, "setGain: the gain");
  if (gain < 0) raise(L, "setGain: {:g} must not be negative", gain);
  running(L, *get<RobotPointer>(L, 1, "setGain: the robot"), "setGain").pilot().set_gain(gain / kGainUnit);
  return 0;
}

int unplug(lua_State* L) {
  running(L, *get<RobotPointer>(L, 1, "unplug: the robot"), "unplug").unplug(boolean_at(L, 2, "unplug"));
  return 0;
}

int reset_board(lua_State* L) {
  running(L, *get<RobotPointer>(L, 1, "resetBoard: the robot"), "resetBoard").reset_board();
  return 0;
}

int set_power(lua_State* L) {
  running(L, *get<RobotPointer>(L, 1, "setPower: the robot"), "setPower").set_powered(boolean_at(L, 2, "setPower"));
  return 0;
}

int set_supply(lua_State* L) {
  const double volts = number_at(L, 2, "setSupply: the voltage");
  if (volts < 0) raise(L, "setSupply: {:g} V must not be negative", volts);
  running(L, *get<RobotPointer>(L, 1, "setSupply: the robot"), "setSupply").plant().set_supply_voltage(volts);
  return 0;
}

int hide_base(lua_State* L) {
  const bool is_hidden = boolean_at(L, 2, "hideBase");
  running(L, *get<RobotPointer>(L, 1, "hideBase: the robot"), "hideBase").tracker().hide(is_hidden);
  return 0;
}

int swap_axes(lua_State* L) {
  running(L, *get<RobotPointer>(L, 1, "swapAxes: the robot"), "swapAxes")
      .tracker()
      .swap_axes(boolean_at(L, 2, "swapAxes"));
  return 0;
}

int block_wheel(lua_State* L) {
  robot::Robot& robot = running(L, *get<RobotPointer>(L, 1, "blockWheel: the robot"), "blockWheel");
  robot.plant().set_blocked(wheel_at(L, 2, "blockWheel"), boolean_at(L, 3, "blockWheel"));
  return 0;
}

int break_encoder(lua_State* L) {
  robot::Robot& robot = running(L, *get<RobotPointer>(L, 1, "breakEncoder: the robot"), "breakEncoder");
  const std::size_t wheel = wheel_at(L, 2, "breakEncoder");
  const std::string how = text_at(L, 3, "breakEncoder: how");
  if (how != "dead" && how != "reversed" && how != "none")
    raise(L, "breakEncoder: '{}'{}", how, suggestion(how, {"dead", "reversed", "none"}));
  robot.plant().set_encoder_fault(wheel, how == "dead"       ? robot::EncoderFault::dead
                                         : how == "reversed" ? robot::EncoderFault::reversed
                                                             : robot::EncoderFault::none);
  return 0;
}

using Method = int (*)(lua_State*);
template <Method method>
void push_method(lua_State* L) {
  push_function<method, Charge::call>(L);
}
struct NamedMethod {
  const char* name;
  void (*push)(lua_State*);
};
constexpr std::array kMethods = {
    NamedMethod{"killServer", push_method<kill_server>},     NamedMethod{"startServer", push_method<start_server>},
    NamedMethod{"setGain", push_method<set_gain>},           NamedMethod{"unplug", push_method<unplug>},
    NamedMethod{"resetBoard", push_method<reset_board>},     NamedMethod{"setPower", push_method<set_power>},
    NamedMethod{"setSupply", push_method<set_supply>},       NamedMethod{"hideBase", push_method<hide_base>},
    NamedMethod{"swapAxes", push_method<swap_axes>},         NamedMethod{"blockWheel", push_method<block_wheel>},
    NamedMethod{"breakEncoder", push_method<break_encoder>},
};

int robot_member(lua_State* L) {
  const RobotPointer node = get<RobotPointer>(L, 1, "what a robot's word is called on");
  const std::string name = text_at(L, 2, "a robot's member");
  for (const NamedMethod& method : kMethods)
    if (name == method.name) return method.push(L), 1;
  const bool runs = ScriptState::of(L).simulation != nullptr;
  const Pose at_start = robot::base_in_world(node->settings.start, node->settings.device);
  if (name == "name")
    push_text(L, node->name);
  else if (name == "tracker")
    push_text(L, node->tracker);
  else if (name == "pose")
    push(L, runs ? Pose(node->base->pose()) : at_start);
  else if (name == "position")
    push(L, Vector3d(runs ? node->base->pose().position : at_start.position));
  else if (name == "trackedPose")
    push(L, runs ? Pose(node->base->tracked_pose()) : at_start);
  else if (name == "heading")
    lua_pushnumber(L, runs && node->robot ? node->robot->place().theta : node->settings.start.theta);
  else {
    std::vector<std::string> known = {"name", "tracker", "pose", "position", "trackedPose", "heading"};
    for (const NamedMethod& method : kMethods) known.emplace_back(method.name);
    raise(L, "a Robot has no '{}'{}", name, suggestion(name, known));
  }
  return 1;
}

int robot_text(lua_State* L) {
  push_text(L, fmt::format("Robot '{}'", get<RobotPointer>(L, 1, "a robot")->name));
  return 1;
}

// --- VRPNRemoteBase -------------------------------------------------------------------------------------------------

/// The robot whose server is called so; null: there is none.
RobotPointer robot_served_by(const ScriptState& state, const std::string& server) {
  for (const auto& companion : state.companions)
    if (auto robot = std::dynamic_pointer_cast<RobotNode>(companion); robot && robot->server == server) return robot;
  return nullptr;
}

// VRPNRemoteBase(device, x, z, "Robot@localhost").
int remote_base(lua_State* L) {
  check_building(L, kRemoteBase);
  ScriptState& state = ScriptState::of(L);
  DevicePointer node = new_filter(L, device_at(L, 1, "VRPNRemoteBase: the device"));
  record_once(L, *node, kRemoteBase, "a remote base");
  RemoteBaseDescription description;
  description.neutral_x = number_at(L, 2, "VRPNRemoteBase: x of the neutral place");
  description.neutral_z = number_at(L, 3, "VRPNRemoteBase: z of the neutral place");
  description.server = text_at(L, 4, "VRPNRemoteBase: the server");
  node->gain = std::make_shared<double>(1);
  description.gain = node->gain;
  node->make = [&state, description](const DeviceMaking& making) -> std::shared_ptr<Device> {
    const std::string server = description.server.substr(0, description.server.find('@'));
    const RobotPointer robot = robot_served_by(state, server);
    if (robot) return make_remote_base(making.inner, robot->base_of(state.inputs, making.seed), description);
    state.notice(fmt::format("{}: no Robot of this scene has the server '{}'; the base of '{}' stays where it is",
                             kRemoteBase, server, making.name));
    return making.inner;
  };
  push(L, node);
  return 1;
}

}  // namespace

std::shared_ptr<MovingBase> base_tracked_by(ScriptState& state, const std::string& tracker, std::uint64_t seed) {
  for (const auto& companion : state.companions)
    if (const auto robot = std::dynamic_pointer_cast<RobotNode>(companion); robot && robot->tracker == tracker)
      return robot->base_of(state.inputs, seed);
  return nullptr;
}

void add_robot_words(lua_State* L) {
  push_metatable<RobotPointer>(L);
  set_function<robot_member, Charge::call>(L, "__index");
  set_function<refuse_assignment, Charge::call>(L, "__newindex");
  set_function<robot_text, Charge::call>(L, "__tostring");
  lua_pop(L, 1);
  set_global<robot_word, Charge::call>(L, "Robot");
  set_global<remote_base, Charge::call>(L, "VRPNRemoteBase");
}

}  // namespace verisim::script
