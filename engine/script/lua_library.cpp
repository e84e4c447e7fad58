// The part of Lua's standard library that a scenario sees, with replacements for what differs between runs: addresses,
// clocks, the order of pairs, random numbers, files.
#include <algorithm>
#include <bit>
#include <cmath>
#include <new>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

#include "engine/base/text.hpp"
#include "engine/script/sandbox.hpp"

namespace verisim::script {
namespace {

bool is_object(int type) {
  return type == LUA_TTABLE || type == LUA_TFUNCTION || type == LUA_TUSERDATA || type == LUA_TTHREAD;
}

bool has_object_keys(lua_State* L, int table) {
  // To the end in any case: in which slot an object stands, and with it the work up to there, differs from run to run.
  bool found = false;
  for (lua_pushnil(L); lua_next(L, table) != 0; lua_pop(L, 1)) found = found || is_object(lua_type(L, -2));
  return found;
}

int next_key(lua_State* L) {
  luaL_checktype(L, 1, LUA_TTABLE);
  lua_settop(L, 2);
  if (lua_isnil(L, 2) && has_object_keys(L, 1))
    raise(L,
          "next() over a table whose keys are tables or functions has no order that is the same in every run; use "
          "pairs()");
  return lua_next(L, 1) != 0 ? 2 : (lua_pushnil(L), 1);
}

int plain_next(lua_State* L) {
  luaL_checktype(L, 1, LUA_TTABLE);
  lua_settop(L, 2);
  return lua_next(L, 1) != 0 ? 2 : (lua_pushnil(L), 1);
}

// Keys of one table in an order that depends on nothing but the script: numbers, texts, false and true, then objects in
// the order in which they were made.
struct OrderedKey {
  int rank;
  double number;
  std::string_view text;  ///< in the key itself
  std::uint64_t order;
  int position;  ///< in the list of keys as the table has them
  bool operator<(const OrderedKey& other) const {
    if (rank != other.rank) return rank < other.rank;
    if (number != other.number) return number < other.number;
    if (text != other.text) return text < other.text;
    return order < other.order;
  }
};

OrderedKey ordered_key(lua_State* L, int index, int position) {
  OrderedKey key{.rank = 0, .number = 0, .text = {}, .order = 0, .position = position};
  switch (lua_type(L, index)) {
    case LUA_TNUMBER:
      key.number = lua_tonumber(L, index);
      break;
    case LUA_TSTRING: {
      std::size_t size = 0;
      const char* data = lua_tolstring(L, index, &size);
      key.rank = 1;
      key.text = {data, size};
      break;
    }
    case LUA_TBOOLEAN:
      key.rank = 2;
      key.number = lua_toboolean(L, index);
      break;
    default:
      key.rank = 3;
      key.order = Sandbox::of(L).creation_order(L, index);
  }
  return key;
}

/// Leaves a block of Lua's memory on the stack: the list counts as the script's.
std::span<OrderedKey> new_keys(lua_State* L, int count) {
  static_assert(std::is_trivially_destructible_v<OrderedKey> && alignof(OrderedKey) <= 8);
  const auto size = static_cast<std::size_t>(count);
  return {static_cast<OrderedKey*>(lua_newuserdata(L, size * sizeof(OrderedKey))), size};
}

// Upvalues: the table, the list of its keys in order, the number of keys given out.
int next_of_ordered(lua_State* L) {
  auto given = static_cast<int>(lua_tonumber(L, lua_upvalueindex(3)));
  while (true) {
    lua_rawgeti(L, lua_upvalueindex(2), ++given);
    if (lua_isnil(L, -1)) return 1;
    lua_pushvalue(L, -1);
    lua_rawget(L, lua_upvalueindex(1));
    if (!lua_isnil(L, -1)) break;  // else: removed by the loop's body
    lua_pop(L, 2);
  }
  lua_pushnumber(L, given);
  lua_replace(L, lua_upvalueindex(3));
  return 2;
}

int pairs(lua_State* L) {
  luaL_checktype(L, 1, LUA_TTABLE);
  lua_settop(L, 1);
  if (!has_object_keys(L, 1)) {
    lua_getfield(L, LUA_REGISTRYINDEX, "verisim.next");
    lua_pushvalue(L, 1);
    lua_pushnil(L);
    return 3;
  }
  lua_newtable(L);
  int count = 0;
  for (lua_pushnil(L); lua_next(L, 1) != 0; lua_pop(L, 1)) {
    lua_pushvalue(L, -2);
    lua_rawseti(L, 2, ++count);
  }
  Sandbox::charge(L, 20 * static_cast<std::uint64_t>(count) * std::bit_width(static_cast<unsigned>(count)));
  const std::span<OrderedKey> keys = new_keys(L, count);  // 3
  for (int i = 1; i <= count; ++i) {
    lua_rawgeti(L, 2, i);
    new (&keys[static_cast<std::size_t>(i) - 1]) OrderedKey(ordered_key(L, -1, i));
    lua_pop(L, 1);
  }
  std::sort(keys.begin(), keys.end());
  lua_pushvalue(L, 1);
  lua_createtable(L, count, 0);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    lua_rawgeti(L, 2, keys[i].position);
    lua_rawseti(L, -2, static_cast<int>(i + 1));
  }
  lua_remove(L, 3);
  lua_pushnumber(L, 0);
  push_function<next_of_ordered, Charge::call>(L, 3);
  return 1;
}

int to_string(lua_State* L) {
  luaL_checkany(L, 1);
  if (luaL_callmeta(L, 1, "__tostring") != 0) return 1;
  const int type = lua_type(L, 1);
  if (type == LUA_TNUMBER) {
    lua_pushvalue(L, 1);
    lua_tostring(L, -1);
  } else if (type == LUA_TSTRING) {
    lua_pushvalue(L, 1);
  } else if (type == LUA_TBOOLEAN) {
    lua_pushstring(L, lua_toboolean(L, 1) != 0 ? "true" : "false");
  } else if (is_object(type)) {
    const std::string text = fmt::format("{}: 0x{:08x}", lua_typename(L, type), Sandbox::of(L).shown_number(L, 1));
    lua_pushlstring(L, text.data(), text.size());
  } else {
    lua_pushstring(L, lua_typename(L, type));
  }
  return 1;
}

int print(lua_State* L) {
  std::string line;
  std::size_t left_out = 0;
  const int count = lua_gettop(L);
  for (int i = 1; i <= count; ++i) {
    push_function<to_string, Charge::call>(L);
    lua_pushvalue(L, i);
    lua_call(L, 1, 1);
    std::size_t size = 0;
    const char* text = lua_tolstring(L, -1, &size);
    if (text == nullptr) raise(L, "'tostring' must give a text to print");
    if (i > 1) line += '\t';
    constexpr std::size_t kLongest = 10'000;  // what is more is counted and left out
    const std::size_t taken = std::min(size, kLongest - std::min(line.size(), kLongest));
    line.append(text, taken);
    left_out += size - taken;
    lua_pop(L, 1);
  }
  Sandbox::charge(L, line.size());
  if (left_out > 0) line += fmt::format(" … ({} more bytes)", left_out);
  Sandbox::of(L).print(line);
  return 0;
}

constexpr std::size_t kLongestSource = std::size_t{16} << 20;

// load(f) and loadstring(s): text only, since compiled Lua could break out of the sandbox.
int load_text(lua_State* L) {
  std::string content;
  if (lua_isfunction(L, 1)) {
    while (true) {
      lua_pushvalue(L, 1);
      lua_call(L, 0, 1);
      std::size_t size = 0;
      const char* piece = lua_tolstring(L, -1, &size);
      if (piece == nullptr || size == 0) break;
      Sandbox::charge(L, size);
      if (content.size() + size > kLongestSource) raise(L, "load() was given more than 16 MiB of text");
      content.append(piece, size);
      lua_pop(L, 1);
    }
  } else {
    std::size_t size = 0;
    const char* data = luaL_checklstring(L, 1, &size);
    if (size > kLongestSource) raise(L, "loadstring() was given more than 16 MiB of text");
    content.assign(data, size);
  }
  std::string name = shown(luaL_optstring(L, 2, "text"), kLongestName);
  if (!name.empty() && (name.front() == '@' || name.front() == '=')) name.erase(0, 1);
  lua_settop(L, 0);
  if (const auto failure = Sandbox::of(L).load(L, name, content)) {
    lua_pushnil(L);
    lua_pushlstring(L, failure->text.data(), failure->text.size());
    return 2;
  }
  return 1;
}

// No control: garbage collection must not depend on the script, nor the script on it.
int collect_garbage(lua_State* L) {
  lua_pushnumber(L, 0);
  return 1;
}

int random_number(lua_State* L) {
  const double r = Sandbox::of(L).random();
  if (lua_gettop(L) == 0) {
    lua_pushnumber(L, r);
    return 1;
  }
  const double low = lua_gettop(L) == 1 ? 1 : std::floor(luaL_checknumber(L, 1));
  const double high = std::floor(luaL_checknumber(L, lua_gettop(L) == 1 ? 1 : 2));
  if (!(low <= high)) raise(L, "math.random({:g}, {:g}): the interval is empty", low, high);
  lua_pushnumber(L, std::min(high, low + std::floor(r * (high - low + 1))));
  return 1;
}

int seed_random(lua_State* L) {
  Sandbox::of(L).seed_random(luaL_optnumber(L, 1, 0));
  return 0;
}

int simulated_clock(lua_State* L) {
  lua_pushnumber(L, Sandbox::of(L).clock());
  return 1;
}
int simulated_seconds(lua_State* L) {
  lua_pushnumber(L, std::floor(Sandbox::of(L).clock()));
  return 1;
}
int difference(lua_State* L) {
  lua_pushnumber(L, luaL_checknumber(L, 1) - luaL_optnumber(L, 2, 0));
  return 1;
}
int no_environment(lua_State* L) {
  lua_pushnil(L);
  return 1;
}
int exit_script(lua_State* L) {
  Sandbox::of(L).stop();
  return 0;
}

void open(lua_State* L, lua_CFunction library, const char* name) {
  lua_pushcfunction(L, library);
  lua_pushstring(L, name);
  lua_call(L, 1, 0);
}

void open_base(lua_State* L) {
  lua_pushvalue(L, LUA_GLOBALSINDEX);
  set_function<next_key, Charge::call>(L, "next");
  set_function<pairs, Charge::own>(L, "pairs");
  set_function<to_string, Charge::call>(L, "tostring");
  set_function<print, Charge::scene>(L, "print");
  set_function<load_text, Charge::own>(L, "load");
  set_function<load_text, Charge::own>(L, "loadstring");
  set_function<collect_garbage, Charge::call>(L, "collectgarbage");
  push_function<plain_next, Charge::call>(L);
  lua_setfield(L, LUA_REGISTRYINDEX, "verisim.next");  // for pairs
  lua_pop(L, 1);
}

void open_os(lua_State* L) {
  lua_newtable(L);
  set_function<simulated_clock, Charge::call>(L, "clock");
  set_function<simulated_seconds, Charge::call>(L, "time");
  set_function<difference, Charge::call>(L, "difftime");
  set_function<no_environment, Charge::call>(L, "getenv");
  set_function<exit_script, Charge::call>(L, "exit");
  lua_setglobal(L, "os");
}

}  // namespace

void open_library(lua_State* L) {
  open(L, luaopen_base, "");
  open(L, luaopen_table, LUA_TABLIBNAME);
  open(L, luaopen_math, LUA_MATHLIBNAME);
  open(L, luaopen_string, LUA_STRLIBNAME);
  keep_declared_functions(L);
  open_base(L);
  open_control(L);
  lua_getglobal(L, LUA_MATHLIBNAME);
  set_function<random_number, Charge::call>(L, "random");
  set_function<seed_random, Charge::call>(L, "randomseed");
  lua_pop(L, 1);
  lua_getglobal(L, LUA_TABLIBNAME);
  open_lists(L);
  lua_pop(L, 1);
  lua_getglobal(L, LUA_STRLIBNAME);
  open_strings(L);
  lua_pop(L, 1);
  open_os(L);
}

}  // namespace verisim::script
