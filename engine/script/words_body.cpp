// The body that addObject returns. Its members read the description while the scene is built, then the simulation.
#include <algorithm>

#include "engine/script/script_state.hpp"
#include "engine/script/values.hpp"

namespace verisim::script {

namespace {

std::size_t body_at(lua_State* L, int index) {
  return get<BodyHandle>(L, index, "what a body's word is called on").index;
}

Pose pose_of(lua_State* L, std::size_t body) {
  ScriptState& state = ScriptState::of(L);
  return state.simulation != nullptr ? state.simulation->body_pose(body) : state.described_body(body).X_WB;
}

void set_pose(lua_State* L, std::size_t body, const Pose& pose) {
  ScriptState& state = ScriptState::of(L);
  if (state.simulation != nullptr)
    state.simulation->set_body_pose(body, pose);
  else
    state.described_body(body).X_WB = pose;
}

// --- members that are read ------------------------------------------------------------------------------------------

using Reader = void (*)(lua_State*, ScriptState&, std::size_t);

void read_name(lua_State* L, ScriptState& state, std::size_t body) {
  push_text(L, state.described_body(body).name);
}
void read_pose(lua_State* L, ScriptState&, std::size_t body) {
  push(L, pose_of(L, body));
}
void read_position(lua_State* L, ScriptState&, std::size_t body) {
  push(L, Vector3d(pose_of(L, body).position));
}
void read_orientation(lua_State* L, ScriptState&, std::size_t body) {
  push(L, Quaterniond(pose_of(L, body).rotation));
}
void read_matrix(lua_State* L, ScriptState&, std::size_t body) {
  push_matrix_of(L, pose_of(L, body));
}

void read_mass(lua_State* L, ScriptState& state, std::size_t body) {
  lua_pushnumber(L, state.simulation != nullptr ? state.simulation->mass(body) : state.masses[body]);
}

// SPARTA's voxelsize is an object with a value.
void read_voxelsize(lua_State* L, ScriptState& state, std::size_t body) {
  lua_newtable(L);
  lua_pushnumber(L, state.described_body(body).voxel_size);
  lua_setfield(L, -2, "value");
}

Wrench force_of(const ScriptState& state, std::size_t body) {
  return state.simulation != nullptr ? state.simulation->body_force(body) : Wrench{};
}
Twist twist_of(ScriptState& state, std::size_t body) {
  return state.simulation != nullptr ? state.simulation->body_twist(body) : state.described_body(body).twist;
}
void read_force(lua_State* L, ScriptState& state, std::size_t body) {
  push(L, Vector3d(force_of(state, body).force));
}
void read_torque(lua_State* L, ScriptState& state, std::size_t body) {
  push(L, Vector3d(force_of(state, body).torque));
}
void read_velocity(lua_State* L, ScriptState& state, std::size_t body) {
  push(L, Vector3d(twist_of(state, body).linear));
}
void read_spin(lua_State* L, ScriptState& state, std::size_t body) {
  push(L, Vector3d(twist_of(state, body).angular));
}

void read_contacts(lua_State* L, ScriptState& state, std::size_t body) {
  lua_pushnumber(L, state.simulation != nullptr ? static_cast<double>(state.simulation->body_contacts(body)) : 0);
}

struct Member {
  const char* name;
  Reader read;
};
constexpr Member kMembers[] = {
    {"name", read_name},
    {"pose", read_pose},
    {"position", read_position},
    {"orientation", read_orientation},
    {"matrix", read_matrix},
    {"mass", read_mass},
    {"voxelsize", read_voxelsize},
    {"force", read_force},
    {"torque", read_torque},
    {"velocity", read_velocity},
    {"angularVelocity", read_spin},
    {"contacts", read_contacts},
};

// --- methods --------------------------------------------------------------------------------------------------------

// body:setPosition(x, y, z) or body:setPosition(vector); the orientation stays.
int set_position(lua_State* L) {
  const std::size_t body = body_at(L, 1);
  Pose pose = pose_of(L, body);
  if (lua_gettop(L) >= 4)
    pose.position = {number_at(L, 2, "setPosition: x"), number_at(L, 3, "setPosition: y"),
                     number_at(L, 4, "setPosition: z")};
  else
    pose.position = vector_at(L, 2, "setPosition: the position");
  set_pose(L, body, pose);
  return 0;
}

int set_orientation(lua_State* L) {
  const std::size_t body = body_at(L, 1);
  Pose pose = pose_of(L, body);
  pose.rotation = rotation_at(L, 2, "setOrientation: the rotation");
  set_pose(L, body, pose);
  return 0;
}

int set_hybrid_enabled(lua_State* L) {
  ScriptState& state = ScriptState::of(L);
  const std::size_t body = body_at(L, 1);
  const bool enabled = boolean_at(L, 2, "setHybridEnabled: the switch");
  BodyDescription& description = state.described_body(body);
  if (state.simulation == nullptr) {
    description.hybrid_enabled = enabled;
    return 0;
  }
  state.simulation->set_hybrid_enabled(body, enabled);
  state.event("hybrid", fmt::format("{} {}", description.name, enabled ? "on" : "off"));
  return 0;
}

// --- access ---------------------------------------------------------------------------------------------------------

int body_member(lua_State* L) {
  const std::size_t body = body_at(L, 1);
  const std::string name = text_at(L, 2, "a body's member");
  for (const Member& member : kMembers) {
    if (name != member.name) continue;
    member.read(L, ScriptState::of(L), body);
    return 1;
  }
  lua_getfield(L, lua_upvalueindex(1), name.c_str());
  if (!lua_isnil(L, -1)) return 1;
  std::vector<std::string> known = {"setPosition",         "setOrientation", "setHybridEnabled",
                                    "foreachSurfaceVoxel", "addFeatureSet",  "getFeatureSet"};
  for (const Member& member : kMembers) known.emplace_back(member.name);
  raise(L, "a body has no '{}'{}", name, suggestion(name, known));
}

int set_body_member(lua_State* L) {
  const std::size_t body = body_at(L, 1);
  const std::string name = text_at(L, 2, "a body's member");
  Pose pose = pose_of(L, body);
  if (name == "matrix")
    pose = pose_of_matrix(L, get<Matrix>(L, 3, "body.matrix"), "body.matrix");
  else if (name == "pose")
    pose = get<Pose>(L, 3, "body.pose");
  else if (name == "position")
    pose.position = vector_at(L, 3, "body.position");
  else if (name == "orientation")
    pose.rotation = rotation_at(L, 3, "body.orientation");
  else
    raise(L, "a body's '{}' cannot be set; matrix, pose, position and orientation can", name);
  set_pose(L, body, pose);
  return 0;
}

int body_text(lua_State* L) {
  push_text(L, fmt::format("body '{}'", ScriptState::of(L).described_body(body_at(L, 1)).name));
  return 1;
}

int same_body(lua_State* L) {
  lua_pushboolean(L, body_at(L, 1) == body_at(L, 2) ? 1 : 0);
  return 1;
}

int pose_member(lua_State* L) {
  const Pose& pose = get<Pose>(L, 1, "what a pose's member is asked of");
  const std::string name = text_at(L, 2, "a pose's member");
  if (name == "position")
    push(L, Vector3d(pose.position));
  else if (name == "orientation")
    push(L, Quaterniond(pose.rotation));
  else if (name == "matrix")
    push_matrix_of(L, pose);
  else
    raise(L, "a pose has no '{}'{}", name, suggestion(name, {"position", "orientation", "matrix"}));
  return 1;
}

}  // namespace

void add_body_words(lua_State* L) {
  push_metatable<BodyHandle>(L);
  set_function<body_text, Charge::call>(L, "__tostring");
  set_function<same_body, Charge::call>(L, "__eq");
  set_function<set_body_member, Charge::call>(L, "__newindex");
  lua_newtable(L);
  set_function<set_position, Charge::call>(L, "setPosition");
  set_function<set_orientation, Charge::call>(L, "setOrientation");
  set_function<set_hybrid_enabled, Charge::call>(L, "setHybridEnabled");
  add_declaring_methods(L);
  push_function<body_member, Charge::call>(L, 1);
  lua_setfield(L, -2, "__index");
  lua_pop(L, 1);
  push_metatable<Pose>(L);
  set_function<pose_member, Charge::call>(L, "__index");
  set_function<refuse_assignment, Charge::call>(L, "__newindex");
  lua_pop(L, 1);
}

}  // namespace verisim::script
