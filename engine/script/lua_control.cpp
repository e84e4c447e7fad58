// pcall, xpcall, coroutines and ipairs: Lua's own, but an error of the work limit passes through all of them, and what
// a caught error costs is charged.
#include <algorithm>
#include <limits>

#include "engine/script/sandbox.hpp"

namespace verisim::script {
namespace {

// To throw and to say which variable was nil, Lua goes through the instructions of the function that failed.
void pay_for_error(lua_State* L) {
  constexpr std::uint64_t kThrowWork = 1000;
  Sandbox::charge(L, kThrowWork + Sandbox::of(L).longest_source() / 8);
}

int protected_call(lua_State* L) {
  luaL_checkany(L, 1);
  const int status = lua_pcall(L, lua_gettop(L) - 1, LUA_MULTRET, 0);
  if (status != 0) pay_for_error(L);
  lua_pushboolean(L, status == 0 ? 1 : 0);
  lua_insert(L, 1);
  return lua_gettop(L);
}

// xpcall(f, handler). Lua's own calls the handler where the error is raised; if that is the work limit's, the handler
// would see it. Here it is called when f has ended.
int call_with_handler(lua_State* L) {
  luaL_checkany(L, 2);
  lua_settop(L, 2);
  lua_pushvalue(L, 1);
  if (lua_pcall(L, 0, LUA_MULTRET, 0) == 0) {
    lua_pushboolean(L, 1);
    lua_replace(L, 2);
    return lua_gettop(L) - 1;
  }
  pay_for_error(L);
  lua_pushvalue(L, 2);
  lua_insert(L, -2);
  lua_call(L, 1, 1);
  lua_pushboolean(L, 0);
  lua_insert(L, -2);
  return 2;
}

// A coroutine that is shorter than the interval of the hook would run for nothing; making one costs that interval.
constexpr std::uint64_t kCoroutineWork = 400;

// Upvalue: Lua's own.
int create_coroutine(lua_State* L) {
  Sandbox::charge(L, kCoroutineWork);
  return lua_tocfunction(L, lua_upvalueindex(1))(L);
}

/// Each coroutine may take as much of the processor's stack as the main script may.
class Resuming {
 public:
  explicit Resuming(lua_State* L) : depth_(Sandbox::of(L).resumed()) {
    constexpr int kDepthMax = 16;
    if (depth_ >= kDepthMax) raise(L, "more than {} coroutines resume each other", kDepthMax);
    ++depth_;
  }
  ~Resuming() { --depth_; }
  Resuming(const Resuming&) = delete;
  Resuming& operator=(const Resuming&) = delete;

 private:
  int& depth_;
};

// Upvalue: Lua's own.
int resume_coroutine(lua_State* L) {
  int results = 0;
  {
    const Resuming resuming(L);
    results = lua_tocfunction(L, lua_upvalueindex(1))(L);
  }
  if (lua_toboolean(L, -results) == 0) pay_for_error(L);
  return results;
}

// Upvalue: what Lua's own coroutine.wrap returned.
int resume_wrapped(lua_State* L) {
  const Resuming resuming(L);
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_insert(L, 1);
  lua_call(L, lua_gettop(L) - 1, LUA_MULTRET);
  return lua_gettop(L);
}

// Upvalue: Lua's own.
int wrap_coroutine(lua_State* L) {
  Sandbox::charge(L, kCoroutineWork);
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_insert(L, 1);
  lua_call(L, lua_gettop(L) - 1, 1);
  push_function<resume_wrapped, Charge::call>(L, 1);
  return 1;
}

int next_index(lua_State* L) {
  const int before = luaL_checkint(L, 2);
  const int i = before < std::numeric_limits<int>::max() ? before + 1 : std::numeric_limits<int>::min();
  luaL_checktype(L, 1, LUA_TTABLE);
  lua_pushinteger(L, i);
  lua_rawgeti(L, 1, i);
  return lua_isnil(L, -1) ? 0 : 2;
}

int each_index(lua_State* L) {
  luaL_checktype(L, 1, LUA_TTABLE);
  push_function<next_index, Charge::call>(L);
  lua_pushvalue(L, 1);
  lua_pushinteger(L, 0);
  return 3;
}

// Sets field `name` of the table on top to F with Lua's own function as its upvalue.
template <int (*F)(lua_State*)>
void replace(lua_State* L, lua_CFunction own, const char* name) {
  lua_pushcfunction(L, own);
  push_function<F, Charge::own>(L, 1);
  lua_setfield(L, -2, name);
}

lua_CFunction own_function(lua_State* L, const char* name) {
  lua_getfield(L, LUA_REGISTRYINDEX, name);
  const lua_CFunction own = lua_tocfunction(L, -1);
  VERISIM_ASSERT(own != nullptr);
  lua_pop(L, 1);
  return own;
}

}  // namespace

void open_control(lua_State* L) {
  set_global<protected_call, Charge::own>(L, "pcall");
  set_global<call_with_handler, Charge::own>(L, "xpcall");
  set_global<each_index, Charge::call>(L, "ipairs");
  lua_getglobal(L, "coroutine");
  replace<create_coroutine>(L, own_function(L, "verisim.create"), "create");
  replace<resume_coroutine>(L, own_function(L, "verisim.resume"), "resume");
  replace<wrap_coroutine>(L, own_function(L, "verisim.wrap"), "wrap");
  lua_pop(L, 1);
}

}  // namespace verisim::script
