// The part of Lua's standard library that a scenario sees, with replacements for what differs between runs: addresses,
// clocks, the order of pairs, random numbers, files.
#include <algorithm>
#include <bit>
#include <cmath>
#include <string>
#include <vector>

#include "engine/script/sandbox.hpp"

namespace verisim::script {
namespace {

bool is_object(int type) {
  return type == LUA_TTABLE || type == LUA_TFUNCTION || type == LUA_TUSERDATA || type == LUA_TTHREAD;
}

bool has_object_keys(lua_State* L, int table) {
  for (lua_pushnil(L); lua_next(L, table) != 0; lua_pop(L, 1)) {
    if (is_object(lua_type(L, -2))) {
      lua_pop(L, 2);
      return true;
    }
  }
  return false;
}

int next_key(lua_State* L) {
  luaL_checktype(L, 1, LUA_TTABLE);
  lua_settop(L, 2);
  if (lua_isnil(L, 2)) {
    Sandbox::of(L).charge(L, 1);
    if (has_object_keys(L, 1))
      raise(L,
            "next() over a table whose keys are tables or functions has no order that is the same in every run; use "
            "pairs()");
  }
  return lua_next(L, 1) != 0 ? 2 : (lua_pushnil(L), 1);
}

// Keys of one table in an order that depends on nothing but the script: numbers, texts, false and true, then objects in
// the order in which they were made.
struct OrderedKey {
  int rank;
  double number;
  std::string text;
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
      key.text.assign(data, size);
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
  std::vector<OrderedKey> keys;
  for (lua_pushnil(L); lua_next(L, 1) != 0; lua_pop(L, 1)) {
    keys.push_back(ordered_key(L, -2, ++count));
    lua_pushvalue(L, -2);
    lua_rawseti(L, 2, count);
  }
  Sandbox::of(L).charge(L, 10 * keys.size());
  std::sort(keys.begin(), keys.end());
  lua_pushvalue(L, 1);
  lua_createtable(L, count, 0);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    lua_rawgeti(L, 2, keys[i].position);
    lua_rawseti(L, -2, static_cast<int>(i + 1));
  }
  lua_pushnumber(L, 0);
  lua_pushcclosure(L, guarded<next_of_ordered>, 3);
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
  const int count = lua_gettop(L);
  for (int i = 1; i <= count; ++i) {
    lua_pushcfunction(L, guarded<to_string>);
    lua_pushvalue(L, i);
    lua_call(L, 1, 1);
    std::size_t size = 0;
    const char* text = lua_tolstring(L, -1, &size);
    if (text == nullptr) raise(L, "'tostring' must give a text to print");
    if (i > 1) line += '\t';
    line.append(text, size);
    lua_pop(L, 1);
  }
  Sandbox::of(L).charge(L, 500 + line.size());  // it is kept outside Lua's memory
  Sandbox::of(L).print(line);
  return 0;
}

// xpcall(f, handler). Lua's own calls the handler where the error is raised; if that is the hook that counts, nothing
// would count the handler's own work. Here it is called when f has ended.
int call_with_handler(lua_State* L) {
  luaL_checkany(L, 2);
  lua_settop(L, 2);
  lua_pushvalue(L, 1);
  if (lua_pcall(L, 0, LUA_MULTRET, 0) == 0) {
    lua_pushboolean(L, 1);
    lua_replace(L, 2);
    return lua_gettop(L) - 1;
  }
  lua_pushvalue(L, 2);
  lua_insert(L, -2);
  lua_call(L, 1, 1);
  lua_pushboolean(L, 0);
  lua_insert(L, -2);
  return 2;
}

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
      Sandbox::of(L).charge(L, size);
      constexpr std::size_t kLongest = std::size_t{16} << 20;
      if (content.size() + size > kLongest) raise(L, "load() was given more than 16 MiB of text");
      content.append(piece, size);
      lua_pop(L, 1);
    }
  } else {
    std::size_t size = 0;
    const char* data = luaL_checklstring(L, 1, &size);
    content.assign(data, size);
  }
  std::string name = luaL_optstring(L, 2, "text");
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

// A coroutine shorter than the interval of the hook would run for nothing; making one costs that interval.
int create_coroutine(lua_State* L) {
  Sandbox::of(L).charge(L, 1000);
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_insert(L, 1);
  lua_call(L, lua_gettop(L) - 1, 1);
  return 1;
}

// table.insert, remove, sort, concat, maxn: Lua's own, after paying for the length of the list.
int charged_by_length(lua_State* L) {
  luaL_checktype(L, 1, LUA_TTABLE);
  const std::size_t length = lua_objlen(L, 1);
  Sandbox::of(L).charge(L, length < 64 ? 1 : length / 8);
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_insert(L, 1);
  lua_call(L, lua_gettop(L) - 1, LUA_MULTRET);
  return lua_gettop(L);
}

int sort_table(lua_State* L) {
  luaL_checktype(L, 1, LUA_TTABLE);
  const std::uint64_t length = lua_objlen(L, 1);
  Sandbox::of(L).charge(L, 4 * length * static_cast<std::uint64_t>(std::bit_width(length)));
  return charged_by_length(L);
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

void remove_fields(lua_State* L, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    lua_pushnil(L);
    lua_setfield(L, -2, name);
  }
}

// Replaces the function `name` of the table on top by F with the former function as its upvalue.
template <int (*F)(lua_State*)>
void wrap(lua_State* L, const char* name) {
  lua_getfield(L, -1, name);
  lua_pushcclosure(L, guarded<F>, 1);
  lua_setfield(L, -2, name);
}

void open(lua_State* L, lua_CFunction library, const char* name) {
  lua_pushcfunction(L, library);
  lua_pushstring(L, name);
  lua_call(L, 1, 0);
}

void open_base(lua_State* L) {
  open(L, luaopen_base, "");
  lua_pushvalue(L, LUA_GLOBALSINDEX);
  lua_getfield(L, -1, "next");
  lua_setfield(L, LUA_REGISTRYINDEX, "verisim.next");  // the plain one, for pairs
  remove_fields(L, {"dofile", "loadfile", "newproxy", "gcinfo"});
  set_function<next_key>(L, "next");
  set_function<pairs>(L, "pairs");
  set_function<to_string>(L, "tostring");
  set_function<print>(L, "print");
  set_function<call_with_handler>(L, "xpcall");
  set_function<load_text>(L, "load");
  set_function<load_text>(L, "loadstring");
  set_function<collect_garbage>(L, "collectgarbage");
  lua_pop(L, 1);
  lua_getglobal(L, "coroutine");
  wrap<create_coroutine>(L, "create");
  wrap<create_coroutine>(L, "wrap");
  lua_pop(L, 1);
}

void open_os(lua_State* L) {
  lua_newtable(L);
  set_function<simulated_clock>(L, "clock");
  set_function<simulated_seconds>(L, "time");
  set_function<difference>(L, "difftime");
  set_function<no_environment>(L, "getenv");
  set_function<exit_script>(L, "exit");
  lua_setglobal(L, "os");
}

}  // namespace

void open_library(lua_State* L) {
  open_base(L);
  open(L, luaopen_table, LUA_TABLIBNAME);
  lua_getglobal(L, LUA_TABLIBNAME);
  remove_fields(L, {"foreach"});  // its order is that of the plain next
  for (const char* name : {"insert", "remove", "concat", "maxn"}) wrap<charged_by_length>(L, name);
  wrap<sort_table>(L, "sort");
  lua_pop(L, 1);
  open(L, luaopen_math, LUA_MATHLIBNAME);
  lua_getglobal(L, LUA_MATHLIBNAME);
  set_function<random_number>(L, "random");
  set_function<seed_random>(L, "randomseed");
  lua_pop(L, 1);
  open(L, luaopen_string, LUA_STRLIBNAME);
  lua_getglobal(L, LUA_STRLIBNAME);
  open_strings(L);
  lua_pop(L, 1);
  open_os(L);
}

}  // namespace verisim::script
