// The filters that wrap devices: translateDevice, rotateDevice, scaleDevice, the bubble and navigation, bump,
// passivity.
#include "engine/device/bubble.hpp"
#include "engine/device/bump.hpp"
#include "engine/device/filters.hpp"
#include "engine/device/hardware.hpp"
#include "engine/device/mobile_base.hpp"
#include "engine/device/passivity_filter.hpp"
#include "engine/device/tracked_transform.hpp"
#include "engine/script/device_node.hpp"
#include "engine/script/robot_node.hpp"
#include "engine/script/script_state.hpp"
#include "engine/script/values.hpp"

namespace verisim::script {

/// TranslationalBubble(radius, stiffness, velocityScale, law).
struct BubbleValue {
  double radius, stiffness, scale;
  BubbleLawKind law;
};
using NavigatorPointer = std::shared_ptr<Navigator>;

template <>
inline constexpr const char* kTypeName<BubbleValue> = "TranslationalBubble";
template <>
inline constexpr const char* kTypeName<NavigatorPointer> = "Navigation";

namespace {

constexpr double kTrackerRate = 60;  ///< Hz, of the trackers of the dissertation's rooms

// --- placement ------------------------------------------------------------------------------------------------------

int translate_device(lua_State* L) {
  Fields fields(L, 1, "translateDevice");
  DevicePointer node = new_filter(L, wrapped_device(L, fields, "translateDevice"));
  const auto translation = fields.vector("translation");
  if (!translation)
    raise(L, "translateDevice needs translation: translateDevice{{ device, translation = {{x, y, z}} }}");
  fields.finish(true);
  node->make = [by = *translation](const DeviceMaking& making) { return make_translate(making.inner, by); };
  push(L, node);
  return 1;
}

int rotate_device(lua_State* L) {
  Fields fields(L, 1, "rotateDevice");
  DevicePointer node = new_filter(L, wrapped_device(L, fields, "rotateDevice"));
  const auto rotation = fields.rotation("rotation");
  if (!rotation)
    raise(L, "rotateDevice needs rotation: rotateDevice{{ device, rotation = AngleAxis(angle, Axis{{x, y, z}}) }}");
  fields.finish(true);
  node->make = [by = *rotation](const DeviceMaking& making) { return make_rotate(making.inner, by); };
  push(L, node);
  return 1;
}

int scale_device(lua_State* L) {
  Fields fields(L, 1, "scaleDevice");
  DevicePointer inner = wrapped_device(L, fields, "scaleDevice");
  const auto factor = fields.positive("scale");
  if (!factor) raise(L, "scaleDevice needs scale: scaleDevice{{ device, scale = 4 }}");
  fields.finish(true);
  push(L, scaled_device(L, std::move(inner), *factor));
  return 1;
}

// TrackedTransform(device, "tracker") or TrackedTransform{ device, tracker = "tracker", rate = 60, delay = 0 }. What a
// third argument meant to SPARTA is not known.
int tracked_transform(lua_State* L) {
  constexpr const char* kWord = "TrackedTransform";
  HardwareDescription tracker = ideal_device("tracker");
  tracker.model = "tracker";
  tracker.rate = kTrackerRate;
  DevicePointer node, base;
  if (lua_istable(L, 1)) {
    Fields fields(L, 1, kWord);
    node = new_filter(L, wrapped_device(L, fields, kWord));
    base = std::make_shared<DeviceNode>();
    if (fields.push("tracker")) {
      base->name = name_at(L, lua_gettop(L), fields.name_of("tracker"));
      lua_pop(L, 1);
    }
    tracker.rate = fields.not_negative("rate", tracker.rate);
    tracker.delay = fields.not_negative("delay", tracker.delay);
    if (fields.push("operator")) {
      base->inner = device_at(L, lua_gettop(L), fields.name_of("operator"));
      if (!base->inner->is_source()) raise(L, "{}: operator must be a source of motion, such as Devices.Replay", kWord);
      lua_pop(L, 1);
    }
    fields.finish(true);
  } else {
    check_building(L, kWord);
    node = new_filter(L, device_at(L, 1, "TrackedTransform: the device"));
    base = std::make_shared<DeviceNode>();
    base->name = name_at(L, 2, "TrackedTransform: the tracker's name");
    if (!lua_isnoneornil(L, 3))
      ScriptState::of(L).notice(
          fmt::format("{}: {}: the third argument is accepted and changes nothing", where(L), kWord));
  }
  if (base->name.empty()) raise(L, "{} needs a tracker: {}{{ device, tracker = \"robot\" }}", kWord, kWord);
  ScriptState::of(L).keep(kNodeBytes);
  base->default_name = "tracker";
  base->place = where(L);
  base->drivable = true;
  base->make = [tracker, &state = ScriptState::of(L)](const DeviceMaking& making) {
    if (const auto robot = making.inner ? nullptr : base_tracked_by(state, making.name, making.seed))
      return make_base_tracker(making.name, robot);
    HardwareDescription named = tracker;
    named.name = making.name;
    return make_hardware(std::move(named), making.inner);
  };
  node->base = std::move(base);
  node->make = [](const DeviceMaking& making) { return make_tracked_transform(making.inner, making.base); };
  push(L, node);
  return 1;
}

// --- the bubble and navigation --------------------------------------------------------------------------------------

/// The laws by the names of TranslationalBubble's fields.
constexpr std::array kLawFields = {"LinearVelocity", "QuadraticVelocity", "CubicVelocity", "PeakRingVelocity",
                                   "PeakRingVelocityAsPrinted"};
static_assert(kLawFields.size() == kBubbleLawNames.size());

BubbleLawKind law_of(lua_State* L, const std::string& name, const std::string& what) {
  for (std::size_t i = 0; i < kBubbleLawNames.size(); ++i)
    if (name == kBubbleLawNames[i] || name == kLawFields[i]) return static_cast<BubbleLawKind>(i);
  raise(L, "{} is '{}', which is no law{}", what, name,
        suggestion(name, {kBubbleLawNames.begin(), kBubbleLawNames.end()}));
}

double positive_at(lua_State* L, int index, const std::string& what) {
  const double value = number_at(L, index, what);
  if (!(value > 0)) raise(L, "{} is {:g} but must be above 0", what, value);
  return value;
}

// TranslationalBubble is a table of laws that can be called.
int translational_bubble(lua_State* L) {
  const std::string word = "TranslationalBubble";
  BubbleValue bubble{positive_at(L, 2, word + ": the radius"), positive_at(L, 3, word + ": the stiffness"),
                     positive_at(L, 4, word + ": the velocity scale"), BubbleLawKind::quadratic};
  if (!lua_isnoneornil(L, 5)) bubble.law = law_of(L, text_at(L, 5, word + ": the law"), word + ": the law");
  push(L, bubble);
  return 1;
}

void read_moves(lua_State* L, Fields& fields, BubbleDescription& bubble) {
  if (fields.boolean("lockedToFloor").value_or(false)) bubble.moves.y() = 0;
  if (!fields.push("navigate")) return;
  // true or false: with the viewpoint or not; there is none here. A vector: along which axes.
  const int index = lua_gettop(L);
  if (lua_type(L, index) != LUA_TBOOLEAN) {
    const Vector3d axes = vector_at(L, index, fields.name_of("navigate"));
    for (int axis = 0; axis < 3; ++axis)
      if (axes[axis] == 0) bubble.moves[axis] = 0;
  }
  lua_pop(L, 1);
}

/// What BubbleTechnique and BubbleNav share.
void read_bubble(lua_State* L, Fields& fields, BubbleDescription& bubble) {
  bubble.radius = fields.positive("radius").value_or(bubble.radius);
  bubble.stiffness = fields.positive("stiffness").value_or(bubble.stiffness);
  bubble.law.scale = fields.positive("bubbleVelocityScale").value_or(bubble.law.scale);
  if (const auto law = fields.text("law")) bubble.law.kind = law_of(L, *law, fields.name_of("law"));
  bubble.law.peak = fields.positive("peak").value_or(bubble.law.peak);
  bubble.law.taper = fields.positive("taper").value_or(bubble.law.taper);
  bubble.center = fields.vector("deviceCenter").value_or(bubble.center);
  bubble.elastic = fields.boolean("elasticForce").value_or(bubble.elastic);
  bubble.stops_in_collision = fields.boolean("stopInCollision").value_or(bubble.stops_in_collision);
  bubble.clear = fields.positive("clear").value_or(bubble.clear);
  read_moves(L, fields, bubble);
  for (const char* drawn : {"showBubble", "wireframeBubble"}) (void)fields.accepted(drawn);
}

DevicePointer bubble_around(lua_State* L, Fields& fields, const char* word, const BubbleDescription& bubble,
                            NavigatorPointer navigator) {
  DevicePointer inner = wrapped_device(L, fields, word);
  const auto position = fields.vector("position");
  fields.finish(true);
  DevicePointer node = new_filter(L, std::move(inner));
  record_once(L, *node, word, "a bubble");
  if (!navigator) navigator = std::make_shared<Navigator>();
  if (position) navigator->displacement = *position - bubble.center;
  node->make = [bubble, navigator](const DeviceMaking& making) { return make_bubble(making.inner, bubble, navigator); };
  return node;
}

int bubble_technique(lua_State* L) {
  Fields fields(L, 1, "BubbleTechnique");
  BubbleDescription bubble;
  read_bubble(L, fields, bubble);
  push(L, bubble_around(L, fields, "BubbleTechnique", bubble, nullptr));
  return 1;
}

int bubble_nav(lua_State* L) {
  Fields fields(L, 1, "BubbleNav");
  BubbleDescription bubble;
  if (fields.push("bubble")) {
    const BubbleValue& value = get<BubbleValue>(L, lua_gettop(L), "BubbleNav: bubble");
    bubble.radius = value.radius;
    bubble.stiffness = value.stiffness;
    bubble.law.scale = value.scale;
    bubble.law.kind = value.law;
    lua_pop(L, 1);
  }
  NavigatorPointer navigator;
  if (fields.push("navigator")) {
    navigator = get<NavigatorPointer>(L, lua_gettop(L), "BubbleNav: navigator");
    lua_pop(L, 1);
  }
  read_bubble(L, fields, bubble);
  push(L, bubble_around(L, fields, "BubbleNav", bubble, std::move(navigator)));
  return 1;
}

int navigation(lua_State* L) {
  check_building(L, "Navigation");
  ScriptState::of(L).keep(sizeof(Navigator));
  push(L, std::make_shared<Navigator>());
  return 1;
}

int transform_device(lua_State* L) {
  check_building(L, "transformDevice");
  const NavigatorPointer navigator = get<NavigatorPointer>(L, 1, "transformDevice: the navigation");
  DevicePointer node = new_filter(L, device_at(L, 2, "transformDevice: the device"));
  node->make = [navigator](const DeviceMaking& making) { return make_carried(making.inner, navigator); };
  push(L, node);
  return 1;
}

int navigation_member(lua_State* L) {
  const NavigatorPointer navigator = get<NavigatorPointer>(L, 1, "a navigation");
  const std::string name = text_at(L, 2, "a navigation's member");
  if (name == "paused")
    lua_pushboolean(L, navigator->paused ? 1 : 0);
  else if (name == "position")
    push(L, Vector3d(navigator->displacement));
  else if (name == "transformDevice")
    push_function<transform_device, Charge::call>(L);
  else
    raise(L, "a navigation has no '{}'{}", name, suggestion(name, {"paused", "position", "transformDevice"}));
  return 1;
}

int set_navigation_member(lua_State* L) {
  const NavigatorPointer navigator = get<NavigatorPointer>(L, 1, "a navigation");
  const std::string name = text_at(L, 2, "a navigation's member");
  if (name != "paused") raise(L, "a navigation's '{}' cannot be set{}", name, suggestion(name, {"paused"}));
  navigator->paused = boolean_at(L, 3, "a navigation's paused");
  return 0;
}

// --- cures ----------------------------------------------------------------------------------------------------------

int bump_device(lua_State* L) {
  Fields fields(L, 1, "bumpDevice");
  DevicePointer node = new_filter(L, wrapped_device(L, fields, "bumpDevice"));
  BumpDescription bump;
  bump.force = fields.positive("force").value_or(bump.force);
  bump.duration = fields.positive("duration").value_or(bump.duration);
  fields.finish(true);
  node->make = [bump](const DeviceMaking& making) { return make_bump(making.inner, bump); };
  push(L, node);
  return 1;
}

int passivity_device(lua_State* L) {
  Fields fields(L, 1, "passivityDevice");
  DevicePointer node = new_filter(L, wrapped_device(L, fields, "passivityDevice"));
  record_once(L, *node, "passivityDevice", "a passivity observer");
  PassivityDescription passivity;
  passivity.controls = fields.boolean("control").value_or(passivity.controls);
  passivity.damping_max = fields.positive("dampingMax").value_or(passivity.damping_max);
  fields.finish(true);
  node->make = [passivity](const DeviceMaking& making) { return make_passivity_filter(making.inner, passivity); };
  push(L, node);
  return 1;
}

void add_bubble_words(lua_State* L) {
  push_metatable<BubbleValue>(L);
  lua_newtable(L);
  for (const char* drawn : {"showBubble", "hideBubble", "setNavIndicatorPos"})
    set_function<no_effect, Charge::call>(L, drawn);
  lua_setfield(L, -2, "__index");
  lua_pop(L, 1);
  lua_newtable(L);
  for (std::size_t i = 0; i < kLawFields.size(); ++i) {
    lua_pushstring(L, kBubbleLawNames[i]);
    lua_setfield(L, -2, kLawFields[i]);
  }
  lua_newtable(L);
  set_function<translational_bubble, Charge::call>(L, "__call");
  lua_setmetatable(L, -2);
  lua_setglobal(L, "TranslationalBubble");
  push_metatable<NavigatorPointer>(L);
  set_function<navigation_member, Charge::call>(L, "__index");
  set_function<set_navigation_member, Charge::call>(L, "__newindex");
  lua_pop(L, 1);
  set_global<navigation, Charge::call>(L, "Navigation");
  set_global<bubble_technique, Charge::call>(L, "BubbleTechnique");
  set_global<bubble_nav, Charge::call>(L, "BubbleNav");
}

}  // namespace

void add_filter_words(lua_State* L) {
  set_global<translate_device, Charge::call>(L, "translateDevice");
  set_global<rotate_device, Charge::call>(L, "rotateDevice");
  set_global<scale_device, Charge::call>(L, "scaleDevice");
  set_global<tracked_transform, Charge::call>(L, "TrackedTransform");
  add_bubble_words(L);
  set_global<bump_device, Charge::call>(L, "bumpDevice");
  set_global<passivity_device, Charge::call>(L, "passivityDevice");
  // SPARTA's word before its version 3.
  set_global<translate_device, Charge::call>(L, "translateManipulator");
}

}  // namespace verisim::script
