#include "engine/script/frame_actions.hpp"

#include <algorithm>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/script/script_state.hpp"

namespace verisim::script {

std::uint64_t FrameActions::add(lua_State* L, int index) {
  VERISIM_ASSERT(lua_isfunction(L, index));
  if (actions_.size() >= kActionsMax) raise(L, "there are {} frame actions already; let some end first", kActionsMax);
  lua_pushvalue(L, index);  // first, since a negative index counts from the top
  lua_State* thread = lua_newthread(L);
  lua_insert(L, -2);
  lua_xmove(L, thread, 1);
  const int reference = luaL_ref(L, LUA_REGISTRYINDEX);
  auto action = std::make_unique<Action>();
  action->id = ++added_;
  action->thread = thread;
  action->reference = reference;
  const auto creator =
      std::find_if(actions_.begin(), actions_.end(), [&](const auto& other) { return other.get() == running_; });
  actions_.insert(creator, std::move(action));
  return added_;
}

bool FrameActions::remove(std::uint64_t id) {
  for (const auto& action : actions_) {
    if (action->id != id || action->removed) continue;
    action->removed = true;
    return true;
  }
  return false;
}

void FrameActions::update(double rate) {
  VERISIM_ASSERT(is_positive(rate));
  VERISIM_ASSERT(running_ == nullptr);
  // Actions that are added meanwhile are inserted between these and wait for the next script frame.
  std::vector<Action*> due;
  due.reserve(actions_.size());
  for (const auto& action : actions_) due.push_back(action.get());
  for (Action* action : due) {
    if (action->removed || ++action->slept < action->wanted) continue;
    resume(*action, static_cast<double>(action->slept) / rate);
  }
  drop_removed();
}

void FrameActions::resume(Action& action, double dt) {
  action.slept = 0;
  action.wanted = 1;  // what a plain coroutine.yield() waits
  running_ = &action;
  lua_settop(action.thread, lua_status(action.thread) == LUA_YIELD ? 0 : 1);
  lua_pushnumber(action.thread, dt);
  state_.allow(kFrameWork);  // each its own: one that loops for ever ends alone
  LuaFailure failure;
  const Sandbox::Resumed resumed = state_.resume(action.thread, 1, failure);
  running_ = nullptr;
  if (resumed != Sandbox::Resumed::yielded) action.removed = true;
  if (resumed == Sandbox::Resumed::failed) state_.report_failure("a frame action failed and was ended", failure);
}

void FrameActions::drop_removed() {
  std::erase_if(actions_, [&](const std::unique_ptr<Action>& action) {
    if (action->removed) luaL_unref(state_.lua(), LUA_REGISTRYINDEX, action->reference);
    return action->removed;
  });
}

int FrameActions::sleep(lua_State* L, std::uint64_t frames, const char* word) {
  if (running_ == nullptr || running_->thread != L)
    raise(L, "Can't call Actions.{} from your main code, only from a frame action!", word);
  VERISIM_ASSERT(frames > 0);
  running_->wanted = frames;
  return lua_yield(L, 0);
}

}  // namespace verisim::script
