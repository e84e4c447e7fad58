// `simulation` and CollisionCounter.
#include <algorithm>

#include "engine/script/script_state.hpp"
#include "engine/script/values.hpp"

namespace verisim::script {
namespace {

using CounterPointer = std::shared_ptr<CollisionCounter>;

// SPARTA's last word of a scene. Here the simulation begins when the script has ended.
int start(lua_State*) {
  return 0;
}

int wait_for_stop(lua_State*) {
  return 0;
}

int stop(lua_State* L) {
  ScriptState::of(L).stop();
  return 0;
}

// Scripts run between two frames: the simulation is always paused for them.
int run_paused(lua_State* L) {
  luaL_checktype(L, 2, LUA_TFUNCTION);
  lua_settop(L, 2);
  lua_call(L, 0, LUA_MULTRET);
  return lua_gettop(L) - 1;
}

int add_frame_task(lua_State* L) {
  ScriptState& state = ScriptState::of(L);
  const CounterPointer counter = get<CounterPointer>(L, 2, "addFrameTask: the task");
  Sandbox::charge(L, state.counters.size());
  if (std::find(state.counters.begin(), state.counters.end(), counter) == state.counters.end())
    state.counters.push_back(counter);
  return 0;
}

int counter_of(lua_State* L) {
  Sandbox::of(L).keep(sizeof(CollisionCounter));
  auto counter = std::make_shared<CollisionCounter>();
  counter->body = get<BodyHandle>(L, 1, "CollisionCounter: the body").index;
  push(L, counter);
  return 1;
}

int voxel_collisions(lua_State* L) {
  lua_pushnumber(L, static_cast<double>(get<CounterPointer>(L, 1, "getNumVoxelCollisions: the counter")->collisions));
  return 1;
}

int reset_counter(lua_State* L) {
  get<CounterPointer>(L, 1, "resetCounter: the counter")->collisions = 0;
  return 0;
}

int simulation_member(lua_State* L) {
  const ScriptState& state = ScriptState::of(L);
  const Simulation* simulation = state.simulation;
  const std::string name = text_at(L, 2, "a member of simulation");
  if (name == "frame")
    lua_pushnumber(L, simulation != nullptr ? static_cast<double>(simulation->frame()) : 0);
  else if (name == "time")
    lua_pushnumber(L, state.time());
  else if (name == "timestep")
    lua_pushnumber(L, state.scene.parameters.timestep);
  else if (name == "collisionFrames")
    lua_pushnumber(L, simulation != nullptr ? static_cast<double>(simulation->collision_frames()) : 0);
  else if (name == "overruns")
    lua_pushnumber(L, 0);  // the wall clock does not enter a simulation
  else
    raise(L, "simulation has no '{}'{}", name,
          suggestion(name, {"frame", "time", "timestep", "collisionFrames", "overruns", "startInSchedulerThread",
                            "waitForStop", "stop", "runFunctionWithSimulationPaused", "addFrameTask"}));
  return 1;
}

}  // namespace

void add_simulation_words(lua_State* L) {
  lua_newtable(L);
  set_function<start, Charge::call>(L, "startInSchedulerThread");
  set_function<wait_for_stop, Charge::call>(L, "waitForStop");
  set_function<stop, Charge::call>(L, "stop");
  set_function<run_paused, Charge::call>(L, "runFunctionWithSimulationPaused");
  set_function<add_frame_task, Charge::call>(L, "addFrameTask");
  lua_newtable(L);
  set_function<simulation_member, Charge::call>(L, "__index");
  lua_setmetatable(L, -2);
  lua_setglobal(L, "simulation");

  push_metatable<CounterPointer>(L);
  lua_newtable(L);
  set_function<voxel_collisions, Charge::call>(L, "getNumVoxelCollisions");
  set_function<reset_counter, Charge::call>(L, "resetCounter");
  lua_setfield(L, -2, "__index");
  lua_pop(L, 1);
  set_global<counter_of, Charge::call>(L, "CollisionCounter");
}

}  // namespace verisim::script
