// Actions and the run buffer (VR JuggLua).
#include <cmath>

#include "engine/script/script_state.hpp"
#include "engine/script/values.hpp"

namespace verisim::script {
namespace {

constexpr double kFramesMax = 1e12;  // years; keeps the count an integer

int add_frame_action(lua_State* L) {
  if (lua_type(L, 1) != LUA_TFUNCTION)
    raise(L, "Actions.addFrameAction: the action must be a function, not {}", described(L, 1));
  push(L, FrameActionHandle{ScriptState::of(L).actions.add(L, 1)});
  return 1;
}

int remove_frame_action(lua_State* L) {
  const auto handle = get<FrameActionHandle>(L, 1, "Actions.removeFrameAction: the action");
  lua_pushboolean(L, ScriptState::of(L).actions.remove(handle.id) ? 1 : 0);
  return 1;
}

int no_wait(lua_State* L) {
  lua_pushnumber(L, 0);
  return 1;
}

int sleep(lua_State* L, double frames, const char* word) {
  return ScriptState::of(L).actions.sleep(L, static_cast<std::uint64_t>(std::min(frames, kFramesMax)), word);
}

int wait_for_redraw(lua_State* L) {
  const double frames =
      lua_isnoneornil(L, 1) ? 1 : std::ceil(number_at(L, 1, "Actions.waitForRedraw: the number of frames"));
  return frames <= 0 ? no_wait(L) : sleep(L, frames, "waitForRedraw");
}

// The least number of whole frames that lasts at least so long; 1 s at 60 Hz is 60 frames, whatever 1/60 rounds to.
int wait_seconds(lua_State* L) {
  const double seconds = number_at(L, 1, "Actions.waitSeconds: the time");
  if (seconds <= 0) return no_wait(L);
  const double frames = std::ceil(seconds * ScriptState::of(L).scene.parameters.frame_rate * (1 - 1e-12));
  return sleep(L, std::max(1.0, frames), "waitSeconds");
}

int update_frame_actions(lua_State*) {
  return 0;
}  // the frame clock updates them

// --- run buffer: chunks run at the next script frame, in order. Unlike VR JuggLua's it drops none. -------------------

int add_string(lua_State* L) {
  ScriptState& state = ScriptState::of(L);
  state.run_buffer.emplace_back("runbuf", any_text_at(L, 2, "runbuf:addString: the code"));
  state.keep(kNodeBytes + state.run_buffer.back().second.size());
  lua_pushboolean(L, 1);
  return 1;
}

int add_file(lua_State* L) {
  ScriptState& state = ScriptState::of(L);
  const std::string name = text_at(L, 2, "runbuf:addFile: the file");
  state.run_buffer.emplace_back(name, state.read_file(L, name));
  state.keep(kNodeBytes + state.run_buffer.back().second.size());
  lua_pushboolean(L, 1);
  return 1;
}

}  // namespace

void add_action_words(lua_State* L) {
  lua_newtable(L);
  set_function<add_frame_action, Charge::call>(L, "addFrameAction");
  set_function<remove_frame_action, Charge::call>(L, "removeFrameAction");
  set_function<wait_for_redraw, Charge::call>(L, "waitForRedraw");
  set_function<wait_seconds, Charge::call>(L, "waitSeconds");
  set_function<update_frame_actions, Charge::call>(L, "updateFrameActions");
  lua_setglobal(L, "Actions");
  lua_newtable(L);
  set_function<add_string, Charge::call>(L, "addString");
  set_function<add_file, Charge::call>(L, "addFile");
  set_function<no_effect, Charge::call>(L, "init");
  set_function<no_effect, Charge::call>(L, "runBuffer");
  lua_setglobal(L, "runbuf");
}

}  // namespace verisim::script
