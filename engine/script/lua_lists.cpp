// table.insert, remove, concat and unpack, which go through lists without running an instruction. Arguments, results
// and errors as in the Lua 5.1 manual, section 5.5.
#include <algorithm>
#include <cstdint>

#include "engine/script/sandbox.hpp"

namespace verisim::script {
namespace {

constexpr std::uint64_t kElementWork = 4;

int list_length(lua_State* L) {
  luaL_checktype(L, 1, LUA_TTABLE);
  return static_cast<int>(lua_objlen(L, 1));
}

void move_element(lua_State* L, int from, int to) {
  Sandbox::charge(L, kElementWork);
  lua_rawgeti(L, 1, from);
  lua_rawseti(L, 1, to);
}

int insert_element(lua_State* L) {
  const int end = list_length(L) + 1;
  int place = end;
  if (lua_gettop(L) == 3) {
    place = luaL_checkint(L, 2);
    for (int i = end; i > place; --i) move_element(L, i - 1, i);
  } else if (lua_gettop(L) != 2) {
    raise(L, "wrong number of arguments to 'insert'");
  }
  lua_rawseti(L, 1, place);
  return 0;
}

int remove_element(lua_State* L) {
  const int end = list_length(L);
  const int place = luaL_optint(L, 2, end);
  if (place < 1 || place > end) return 0;
  lua_rawgeti(L, 1, place);
  for (int i = place; i < end; ++i) move_element(L, i + 1, i);
  lua_pushnil(L);
  lua_rawseti(L, 1, end);
  return 1;
}

void add_element(lua_State* L, luaL_Buffer& buffer, int i) {
  Sandbox::charge(L, kElementWork);
  lua_rawgeti(L, 1, i);
  if (lua_isstring(L, -1) == 0)
    raise(L, "invalid value ({}) at index {} in table for 'concat'", luaL_typename(L, -1), i);
  luaL_addvalue(&buffer);
}

int concatenate(lua_State* L) {
  std::size_t separator_size = 0;
  const char* separator = luaL_optlstring(L, 2, "", &separator_size);
  luaL_checktype(L, 1, LUA_TTABLE);
  const int first = luaL_optint(L, 3, 1);
  const int last = lua_isnoneornil(L, 4) ? list_length(L) : luaL_checkint(L, 4);
  luaL_Buffer buffer;
  luaL_buffinit(L, &buffer);
  for (std::int64_t i = first; i <= last; ++i) {
    add_element(L, buffer, static_cast<int>(i));
    if (i != last) luaL_addlstring(&buffer, separator, separator_size);
  }
  luaL_pushresult(&buffer);
  return 1;
}

// unpack(list, i, j). Lua's own computes j - i + 1 in an int and reads beyond its stack where that overflows.
int unpack_list(lua_State* L) {
  luaL_checktype(L, 1, LUA_TTABLE);
  const std::int64_t first = luaL_optint(L, 2, 1);
  const std::int64_t last = lua_isnoneornil(L, 3) ? list_length(L) : luaL_checkint(L, 3);
  if (first > last) return 0;
  constexpr std::int64_t kMost = 8000;  // Lua's own limit
  const std::int64_t count = last - first + 1;
  if (count >= kMost || lua_checkstack(L, static_cast<int>(count)) == 0) raise(L, "too many results to unpack");
  for (std::int64_t i = first; i <= last; ++i) lua_rawgeti(L, 1, static_cast<int>(i));
  return static_cast<int>(count);
}

}  // namespace

void open_lists(lua_State* L) {
  set_function<insert_element, Charge::own>(L, "insert");
  set_function<remove_element, Charge::own>(L, "remove");
  set_function<concatenate, Charge::own>(L, "concat");
  set_global<unpack_list, Charge::own>(L, "unpack");  // values that are returned are counted by the call itself
}

}  // namespace verisim::script
