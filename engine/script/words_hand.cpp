// Devices.Hand: the operator's path or goals, its arm, and what is human about it.
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/device/hand.hpp"
#include "engine/script/device_node.hpp"
#include "engine/script/script_state.hpp"
#include "engine/script/values.hpp"

namespace verisim::script {

namespace {

constexpr const char* kWord = "Devices.Hand";

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

/// Calls `read` with the index on the stack and the description of each entry of the list that is on top of the stack.
template <typename Read>
void for_each_entry(lua_State* L, const char* field, const char* what, Read read) {
  const int list = lua_gettop(L);
  if (lua_type(L, list) != LUA_TTABLE || lua_objlen(L, list) == 0)
    raise(L, "{}: {} must be a list of {}, not {}", kWord, field, what,
          lua_type(L, list) == LUA_TTABLE ? "an empty one" : described(L, list));
  const auto count = static_cast<int>(lua_objlen(L, list));
  for (int i = 1; i <= count; ++i) {
    lua_rawgeti(L, list, i);
    read(lua_gettop(L), fmt::format("{}: {}[{}]", kWord, field, i));
    lua_pop(L, 1);
  }
  lua_pop(L, 1);
}

/// One of `names` by its index, or `otherwise`.
template <typename Kind, std::size_t N>
Kind kind_of(lua_State* L, Fields& fields, const char* field, const std::array<const char*, N>& names, Kind otherwise) {
  const auto text = fields.text(field);
  if (!text) return otherwise;
  for (std::size_t i = 0; i < N; ++i)
    if (*text == names[i]) return static_cast<Kind>(i);
  raise(L, "{} is '{}'{}", fields.name_of(field), *text, suggestion(*text, {names.begin(), names.end()}));
}

/// { position = {x, y, z}, orientation = q } or {x, y, z}. True if there is an orientation.
bool place_at(lua_State* L, int index, const std::string& what, Pose& place) {
  if (lua_type(L, index) != LUA_TTABLE || lua_objlen(L, index) == 3) {
    place.position = vector_at(L, index, what);
    return false;
  }
  Fields fields(L, index, what);
  const auto position = fields.vector("position");
  if (!position) raise(L, "{} needs position: {{ position = {{x, y, z}}, orientation = q }} or {{x, y, z}}", what);
  place.position = *position;
  const auto rotation = fields.rotation("orientation");
  place.rotation = rotation.value_or(place.rotation);
  fields.finish(false);
  return rotation.has_value();
}

void read_box(lua_State* L, Fields& fields, HandGoal& goal) {
  if (!fields.push("box")) raise(L, "{}: a wander needs box = {{ min = {{x, y, z}}, max = {{x, y, z}} }}", kWord);
  Fields box(L, lua_gettop(L), fields.name_of("box"));
  const auto min = box.vector("min"), max = box.vector("max");
  if (!min || !max) raise(L, "{} needs min and max", fields.name_of("box"));
  box.finish(false);
  lua_pop(L, 1);
  goal.box_min = *min;
  goal.box_max = *max;
}

void read_search(lua_State* L, Fields& fields, HandGoal& goal) {
  goal.from = fields.vector("from");
  goal.strategy = kind_of(L, fields, "strategy", kPegStrategyNames, goal.strategy);
  goal.pitch = fields.positive("pitch").value_or(goal.pitch);
  goal.search_speed = fields.positive("searchSpeed").value_or(goal.search_speed);
  goal.search_radius = fields.positive("searchRadius").value_or(goal.search_radius);
  goal.tilt = fields.positive("tilt").value_or(goal.tilt);
  goal.tip = fields.not_negative("tip", goal.tip);
  goal.press = fields.positive("press").value_or(goal.press);
}

/// The goal whose fields are in `fields`; more of them may be there.
HandGoal read_goal(lua_State* L, Fields& fields, const std::string& what) {
  HandGoal goal;
  if (!fields.push("goal"))
    raise(L, "{} needs goal: \"reach\", \"insert\", \"withdraw\", \"wander\" or \"touch and retreat\"", what);
  lua_pop(L, 1);
  goal.kind = kind_of(L, fields, "goal", kGoalNames, goal.kind);
  if (goal.kind == GoalKind::wander) {
    read_box(L, fields, goal);
    const double places = fields.not_negative("places", 0);
    if (places != std::floor(places) || places > 1e9)
      raise(L, "{} is {:g} but must be a whole number up to 1e9; 0: no end", fields.name_of("places"), places);
    goal.places = static_cast<std::uint32_t>(places);
  } else {
    if (!fields.push("to")) raise(L, "{} needs to: the place, {{x, y, z}} or {{ position =, orientation = }}", what);
    goal.turns = place_at(L, lua_gettop(L), fields.name_of("to"), goal.to);
    lua_pop(L, 1);
  }
  if (goal.kind == GoalKind::insert) read_search(L, fields, goal);
  if (goal.kind == GoalKind::touch) {
    const auto retreat = fields.vector("retreat");
    if (!retreat) raise(L, "{} needs retreat: the place to go to when it has touched", what);
    goal.retreat = *retreat;
    goal.force = fields.positive("force").value_or(goal.force);
    goal.stall = fields.positive("stall").value_or(goal.stall);
    goal.near = fields.positive("near").value_or(goal.near);
  }
  goal.tolerance = fields.positive("tolerance").value_or(goal.tolerance);
  goal.angular_tolerance = fields.positive("angularTolerance").value_or(goal.angular_tolerance);
  goal.speed = fields.positive("speed").value_or(goal.speed);
  goal.dwell = fields.not_negative("dwell", goal.dwell);
  goal.give_up = fields.positive("giveUp").value_or(goal.give_up);
  return goal;
}

void read_goals(lua_State* L, Fields& fields, HandDescription& hand) {
  if (fields.push("goals")) {
    for_each_entry(L, "goals", "goals", [&](int index, const std::string& what) {
      Fields entry(L, index, what);
      hand.goals.push_back(read_goal(L, entry, what));
      entry.finish(false);
    });
  } else {
    hand.goals.push_back(read_goal(L, fields, kWord));
  }
  if (fields.push("start")) {
    (void)place_at(L, lua_gettop(L), fields.name_of("start"), hand.start);
    lua_pop(L, 1);
  }
  hand.watched = kind_of(L, fields, "watch", kWatchedNames, hand.watched);
  hand.reach = fields.positive("reach").value_or(hand.reach);
  hand.push = fields.positive("push").value_or(hand.push);
}

bool has(Fields& fields, lua_State* L, const char* name) {
  if (!fields.push(name)) return false;
  lua_pop(L, 1);
  return true;
}

/// A path in the device's coordinates, or goals in the virtual world.
void read_aim(lua_State* L, Fields& fields, HandDescription& hand) {
  const bool path = has(fields, L, "path"), goals = has(fields, L, "goals"), goal = has(fields, L, "goal");
  if (path && (goals || goal)) raise(L, "{} has both a path and goals; give one of them", kWord);
  if (goals && goal) raise(L, "{} has both goal and goals; give one of them", kWord);
  if (goals || goal) return read_goals(L, fields, hand);
  if (!fields.push("path"))
    raise(L, "{} needs path: a list of waypoints {{ position = {{x, y, z}}, speed = 0.1, dwell = 0 }}, or goals",
          kWord);
  for_each_entry(L, "path", "waypoints",
                 [&](int index, const std::string& what) { hand.path.push_back(waypoint_at(L, index, what)); });
}

// A muscle that is given another stiffness or mass stays critically damped unless its damping is given too.
void read_impedance(lua_State* L, Fields& fields, HandDescription& hand) {
  hand.arm = kind_of(L, fields, "arm", kArmNames, hand.arm);
  if (hand.arm != ArmKind::given)
    for (const char* name : {"mass", "stiffness", "damping"})
      if (has(fields, L, name))
        raise(L, "{}: arm = \"{}\" has a {} of its own; leave one of them out", kWord,
              kArmNames[static_cast<std::size_t>(hand.arm)], name);
  hand.mass = fields.positive("mass").value_or(hand.mass);
  hand.stiffness = fields.positive("stiffness").value_or(hand.stiffness);
  hand.damping = fields.not_negative("damping", 2 * std::sqrt(hand.stiffness * hand.mass));
  hand.inertia = fields.positive("inertia").value_or(hand.inertia);
  hand.angular_stiffness = fields.positive("angularStiffness").value_or(hand.angular_stiffness);
  hand.angular_damping = fields.not_negative("angularDamping", 2 * std::sqrt(hand.angular_stiffness * hand.inertia));
}

int hand_device(lua_State* L) {
  check_building(L, kWord);
  Fields fields(L, 1, kWord);
  DevicePointer node = new_device(L, fields, "hand");
  HandDescription hand;
  read_aim(L, fields, hand);
  // `repeat` is a keyword of Lua: as a key it needs ["repeat"].
  hand.repeat = fields.boolean("loop").value_or(false);
  hand.repeat = fields.boolean("repeat").value_or(hand.repeat);
  read_impedance(L, fields, hand);
  hand.lead = fields.positive("lead").value_or(hand.lead);
  hand.patience = fields.positive("patience").value_or(hand.patience);
  hand.force_max = fields.positive("greatestForce");
  if (has(fields, L, "reaction")) hand.reaction = fields.not_negative("reaction", 0);
  hand.tremor = fields.not_negative("tremor", 0);
  hand.angular_tremor = fields.not_negative("angularTremor", 0);
  hand.error = fields.vector("error").value_or(Vector3d::Zero());
  hand.angular_error = fields.vector("angularError").value_or(Vector3d::Zero());
  const std::optional<double> seed = fields.number("seed");
  if (seed && (*seed < 0 || *seed > 0x1p53 || *seed != std::floor(*seed)))
    raise(L, "{}: seed must be a whole number, not {:g}", kWord, *seed);
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

}  // namespace

void add_hand_word(lua_State* L) {
  set_function<hand_device, Charge::call>(L, "Hand");
}

}  // namespace verisim::script
