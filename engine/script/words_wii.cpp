// WiiHead: a head that a Wii Remote watches beside the loop.
#include <algorithm>

#include "engine/script/head_node.hpp"
#include "engine/script/script_state.hpp"
#include "engine/script/values.hpp"
#include "engine/script/wii_recording.hpp"

namespace verisim::script {

std::shared_ptr<Companion> HeadNode::make(Inputs& inputs, std::uint64_t seed) {
  std::unique_ptr<wii::ReportSource> source;
  if (trace.empty()) {
    virtual_remote.name = name;
    virtual_remote.seed = seed;
    source = wii::make_virtual_source(virtual_remote);
  } else {
    source = wii::make_recorded_source(read_wii_recording(inputs, trace, limits));
  }
  head = std::make_shared<wii::Head>(name, std::move(source), tracker, X_WL);
  return head;
}

namespace {

wii::LedLayout leds_at(lua_State* L, int index) {
  const std::string what = "WiiHead: leds";
  const auto count = lua_type(L, index) == LUA_TTABLE ? static_cast<int>(lua_objlen(L, index)) : 0;
  if (count < 2 || count > wii::kLedsMax)
    raise(L, "{} must be a list of 2 to {} places {{x, y, z}} on the head", what, wii::kLedsMax);
  wii::LedLayout leds;
  leds.count = count;
  for (int i = 0; i < count; ++i) {
    lua_rawgeti(L, index, i + 1);
    leds.p_H[static_cast<std::size_t>(i)] = vector_at(L, lua_gettop(L), fmt::format("{}[{}]", what, i + 1));
    lua_pop(L, 1);
  }
  return leds;
}

/// remote = "trace.csv", or remote = { motion =, sensor = }.
void read_remote(lua_State* L, Fields& fields, HeadNode& head) {
  if (!fields.push("remote")) return;
  const int index = lua_gettop(L);
  if (lua_type(L, index) == LUA_TSTRING) {
    head.trace = text_at(L, index, "WiiHead: remote");
  } else {
    Fields remote(L, index, "WiiHead: remote");
    head.virtual_remote.trajectory = remote.text("motion").value_or(head.virtual_remote.trajectory);
    head.virtual_remote.sensor = remote.text("sensor").value_or(head.virtual_remote.sensor);
    remote.finish(false);
  }
  lua_pop(L, 1);
}

const wii::TrackerEntry& tracker_of(lua_State* L, const std::string& tracker) {
  const std::vector<std::string> known = wii::tracker_names();
  if (std::find(known.begin(), known.end(), tracker) == known.end())
    raise(L, "WiiHead: tracker '{}' is not known{}", tracker, suggestion(tracker, known));
  const wii::TrackerEntry& entry = wii::find_tracker(tracker);
  if (entry.remotes > 1) raise(L, "WiiHead: tracker '{}' needs two remotes, but a WiiHead has one", tracker);
  return entry;
}

int wii_head(lua_State* L) {
  ScriptState& state = ScriptState::of(L);
  if (state.simulation != nullptr) raise(L, "WiiHead: the simulation runs already; call it while the scene is built");
  Sandbox::charge(L, 1000 + 100 * state.companions.size());
  state.keep(100'000);  // a virtual remote and a tracker
  Fields fields(L, 1, "WiiHead");
  auto head = std::make_shared<HeadNode>();
  head->word = "WiiHead";
  head->place = where(L);
  head->name = fields.name().value_or("head");
  head->tracker = fields.text("tracker").value_or(head->tracker);
  head->virtual_remote.leds = tracker_of(L, head->tracker).leds;
  read_remote(L, fields, *head);
  if (fields.push("leds")) {
    head->virtual_remote.leds = leds_at(L, lua_gettop(L));
    lua_pop(L, 1);
  }
  head->X_WL.position = fields.vector("position").value_or(Vector3d::Zero());
  head->X_WL.rotation = fields.rotation("orientation").value_or(Quaterniond::Identity());
  head->limits.max_gap = fields.positive("maxGap").value_or(head->limits.max_gap);
  head->limits.allow_gaps = fields.boolean("allowGaps").value_or(false);
  fields.finish(false);
  state.add_companion(L, head);
  push(L, head);
  return 1;
}

/// The tracked position of the head; that of the remote until there is one.
Pose pose_of(const HeadNode& node) {
  if (node.head == nullptr || !node.head->estimate().pose.position.allFinite()) return node.X_WL;
  return node.head->world_pose();
}

int head_member(lua_State* L) {
  const HeadPointer node = get<HeadPointer>(L, 1, "what a head's word is called on");
  const std::string name = text_at(L, 2, "a head's member");
  if (name == "name")
    push_text(L, node->name);
  else if (name == "pose")
    push(L, pose_of(*node));
  else if (name == "position")
    push(L, Vector3d(pose_of(*node).position));
  else if (name == "orientation")
    push(L, Quaterniond(pose_of(*node).rotation));
  else if (name == "matrix")
    push_matrix_of(L, pose_of(*node));
  else if (name == "valid")
    lua_pushboolean(L, node->head != nullptr && node->head->estimate().valid ? 1 : 0);
  else
    raise(L, "a WiiHead has no '{}'{}", name,
          suggestion(name, {"name", "pose", "position", "orientation", "matrix", "valid"}));
  return 1;
}

int head_text(lua_State* L) {
  push_text(L, fmt::format("WiiHead '{}'", get<HeadPointer>(L, 1, "a head")->name));
  return 1;
}

}  // namespace

void add_wii_words(lua_State* L) {
  push_metatable<HeadPointer>(L);
  set_function<head_member, Charge::call>(L, "__index");
  set_function<refuse_assignment, Charge::call>(L, "__newindex");
  set_function<head_text, Charge::call>(L, "__tostring");
  lua_pop(L, 1);
  set_global<wii_head, Charge::call>(L, "WiiHead");
}

}  // namespace verisim::script
