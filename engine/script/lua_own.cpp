// The functions of Lua's own library that a script may call, each with what its call is charged. What is not in the
// list is removed: a script reaches no function that nobody has thought about.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "engine/script/sandbox.hpp"

namespace verisim::script {
namespace {

using OwnWork = std::uint64_t (*)(lua_State*);

// Numbers go to Lua's functions by value: constant. Values that are passed and returned are counted by Lua's calls
// themselves, as are texts that are made (lua_work.cpp) and tables that are searched (lua_tables.cpp).
std::uint64_t constant(lua_State* /*L*/) {
  return 0;
}

std::uint64_t bytes_at(lua_State* L, int index) {
  return lua_type(L, index) == LUA_TSTRING ? lua_objlen(L, index) : 0;
}

std::uint64_t bytes_of_text(lua_State* L) {
  return bytes_at(L, 1) / 2;
}

// string.format: each of the pattern's characters may be a conversion or part of one; texts are copied.
std::uint64_t formatting(lua_State* L) {
  std::uint64_t units = 20 * bytes_at(L, 1);
  for (int i = 2; i <= lua_gettop(L); ++i) units += bytes_at(L, i) / 2;
  return units;
}

// error(text, level), getfenv(level), setfenv(level, table) go through the calls down to that level.
std::uint64_t levels(lua_State* L, int index) {
  constexpr double kCallsMax = 20'000;  // Lua's own limit
  if (lua_type(L, index) != LUA_TNUMBER) return 0;
  const double level = lua_tonumber(L, index);
  return level > 0 ? static_cast<std::uint64_t>(std::min(level, kCallsMax)) : 0;  // nan: 0
}
std::uint64_t levels_first(lua_State* L) {
  return levels(L, 1);
}
std::uint64_t levels_second(lua_State* L) {
  return levels(L, 2);
}

struct OwnFunction {
  const char* library;  ///< "" for globals
  const char* name;
  OwnWork work;
};

constexpr OwnFunction kOwnFunctions[] = {
    {"", "assert", constant},           {"", "error", levels_second},       {"", "getfenv", levels_first},
    {"", "setfenv", levels_first},      {"", "getmetatable", constant},     {"", "setmetatable", constant},
    {"", "rawequal", constant},         {"", "rawget", constant},           {"", "rawset", constant},
    {"", "select", constant},           {"", "tonumber", bytes_of_text},    {"", "type", constant},
    {"coroutine", "running", constant}, {"coroutine", "status", constant},  {"coroutine", "yield", constant},
    {"math", "abs", constant},          {"math", "acos", constant},         {"math", "asin", constant},
    {"math", "atan", constant},         {"math", "atan2", constant},        {"math", "ceil", constant},
    {"math", "cos", constant},          {"math", "cosh", constant},         {"math", "deg", constant},
    {"math", "exp", constant},          {"math", "floor", constant},        {"math", "fmod", constant},
    {"math", "frexp", constant},        {"math", "ldexp", constant},        {"math", "log", constant},
    {"math", "log10", constant},        {"math", "max", constant},          {"math", "min", constant},
    {"math", "mod", constant},          {"math", "modf", constant},         {"math", "pow", constant},
    {"math", "rad", constant},          {"math", "sin", constant},          {"math", "sinh", constant},
    {"math", "sqrt", constant},         {"math", "tan", constant},          {"math", "tanh", constant},
    {"string", "byte", constant},       {"string", "char", constant},       {"string", "format", formatting},
    {"string", "len", constant},        {"string", "lower", bytes_of_text}, {"string", "reverse", bytes_of_text},
    {"string", "sub", constant},        {"string", "upper", bytes_of_text}, {"table", "foreachi", constant},
    {"table", "getn", constant},        {"table", "maxn", constant},        {"table", "setn", constant},
    {"table", "sort", constant},  // its comparisons count themselves
};

// Upvalues: Lua's function, its entry in the list. Called as it stands, so that its messages know its name.
int call_own(lua_State* L) {
  const auto* function = static_cast<const OwnFunction*>(lua_touserdata(L, lua_upvalueindex(2)));
  Sandbox::charge(L, function->work(L));
  return lua_tocfunction(L, lua_upvalueindex(1))(L);
}

const OwnFunction* declared_own(std::string_view library, std::string_view name) {
  const auto* const found =
      std::find_if(std::begin(kOwnFunctions), std::end(kOwnFunctions),
                   [&](const OwnFunction& own) { return own.library == library && own.name == name; });
  return found == std::end(kOwnFunctions) ? nullptr : found;
}

// Of the table on top of the stack.
void keep_declared_of(lua_State* L, const char* library) {
  const int table = lua_gettop(L);
  for (lua_pushnil(L); lua_next(L, table) != 0; lua_pop(L, 1)) {
    if (lua_iscfunction(L, -1) == 0) continue;
    if (const OwnFunction* own = declared_own(library, lua_tostring(L, -2))) {
      lua_pushvalue(L, -1);
      lua_pushlightuserdata(L, const_cast<OwnFunction*>(own));
      push_function<call_own, Charge::own>(L, 2);
    } else {
      lua_pushnil(L);
    }
    lua_pushvalue(L, -3);
    lua_insert(L, -2);
    lua_rawset(L, table);  // a key that is there: next() goes on
  }
}

}  // namespace

void keep_declared_functions(lua_State* L) {
  lua_getglobal(L, "coroutine");
  for (const char* name : {"create", "resume", "wrap"}) {  // lua_control.cpp calls them
    lua_getfield(L, -1, name);
    lua_setfield(L, LUA_REGISTRYINDEX, fmt::format("verisim.{}", name).c_str());
  }
  lua_pop(L, 1);
  lua_pushvalue(L, LUA_GLOBALSINDEX);
  keep_declared_of(L, "");
  lua_pop(L, 1);
  for (const char* library : {"coroutine", "math", "string", "table"}) {
    lua_getglobal(L, library);
    keep_declared_of(L, library);
    lua_pop(L, 1);
  }
}

}  // namespace verisim::script
