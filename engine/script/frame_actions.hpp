// Frame actions: functions of a script that live on while the simulation runs, each in its own coroutine, resumed once
// a script frame (VR JuggLua's Actions).
//
// Order: actions run in the order in which they were added. An action that was added inside another first runs in the
// next script frame, just before the one that added it. The first resume passes dt; it happens at the next update,
// never when adding. An action that fails ends; the others and the simulation go on. Unlike in VR JuggLua, remove()
// also works inside an action, on itself and on one that has not yet run in this script frame.
#pragma once

#include <cstdint>
#include <lua.hpp>
#include <memory>
#include <vector>

namespace verisim::script {

class ScriptState;

class FrameActions {
 public:
  explicit FrameActions(ScriptState& state) : state_(state) {}

  /// The function at `index` of L becomes an action. Raises if there are kActionsMax already.
  /// @pre there is a function at `index`
  std::uint64_t add(lua_State* L, int index);
  /// False if the action has ended or was removed.
  bool remove(std::uint64_t id);
  /// One script frame of 1 / rate seconds: resumes what is due. @pre rate is finite and above 0; no action runs
  void update(double rate);

  /// Lets the action that runs on L sleep for so many frames. For lua_CFunctions: return sleep(...).
  /// Raises if L is no action's coroutine (`word` begins the message). @pre frames > 0
  int sleep(lua_State* L, std::uint64_t frames, const char* word);
  [[nodiscard]] std::size_t count() const { return actions_.size(); }

 private:
  struct Action {
    std::uint64_t id;
    lua_State* thread;
    int reference;             ///< keeps the coroutine alive in Lua's registry
    std::uint64_t slept = 0;   ///< frames since the last resume
    std::uint64_t wanted = 1;  ///< resume after so many
    bool removed = false;
  };
  void resume(Action& action, double dt);
  void drop_removed();

  ScriptState& state_;
  std::vector<std::unique_ptr<Action>> actions_;
  Action* running_ = nullptr;
  std::uint64_t added_ = 0;
};

}  // namespace verisim::script
