// Words of VR JuggLua that only draw, play sounds or open a window: accepted, ignored, and reported once per word and
// line.
#include "engine/base/text.hpp"
#include "engine/script/script_state.hpp"
#include "engine/script/values.hpp"

namespace verisim::script {

namespace {

int drawing_call(lua_State* L) {
  lua_getfield(L, LUA_REGISTRYINDEX, "verisim.drawing");
  return 1;
}

int ignore_assignment(lua_State*) {
  return 0;
}

// Flags of drawing are added and joined: osg.StateAttribute.Values.ON + …
int drawing_arithmetic(lua_State* L) {
  return drawing_call(L);
}

int drawing_text(lua_State* L) {
  lua_pushliteral(L, "drawing");
  return 1;
}

void say_ignored(lua_State* L, const std::string& name) {
  Sandbox::charge(L, kEventWork);
  ScriptState::of(L).notice(fmt::format("{}: {} only draws or sounds and is ignored", where(L), name));
}

// osg.Material and the like: members of a known table that this program has no use for.
int unknown_member(lua_State* L) {
  const std::string name = lua_type(L, 2) == LUA_TSTRING ? shown({lua_tostring(L, 2), lua_objlen(L, 2)}, 40) : "?";
  say_ignored(L, fmt::format("{}.{}", lua_tostring(L, lua_upvalueindex(1)), name));
  return drawing_call(L);
}

int ignored_word(lua_State* L) {
  say_ignored(L, lua_tostring(L, lua_upvalueindex(1)));
  return drawing_call(L);
}

// Groups that draw their children in some way: for a body they are groups. Switch{ node, … } shows all of them.
int drawing_group(lua_State* L) {
  const std::string word = lua_tostring(L, lua_upvalueindex(1));
  say_ignored(L, "what " + word + " draws");
  if (lua_type(L, 1) != LUA_TTABLE) return drawing_call(L);
  auto group = std::make_shared<Node>();
  const auto count = static_cast<int>(lua_objlen(L, 1));
  Sandbox::of(L).keep(kNodeBytes + 32 * static_cast<std::size_t>(count));
  for (int i = 1; i <= count; ++i) {
    lua_rawgeti(L, 1, i);
    if (const auto* child = get_if<std::shared_ptr<Node>>(L, lua_gettop(L))) group->children.push_back(*child);
    lua_pop(L, 1);
  }
  push(L, group);
  return 1;
}

template <int (*F)(lua_State*)>
void add_words(lua_State* L, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    lua_pushstring(L, name);
    push_function<F, Charge::call>(L, 1);
    lua_setglobal(L, name);
  }
}

// Members that the table `name` does not have are drawing's; makes the table if there is none.
void accept_members(lua_State* L, const char* name) {
  lua_getglobal(L, name);
  if (lua_isnil(L, -1)) {
    lua_pop(L, 1);
    lua_newtable(L);
    lua_pushvalue(L, -1);
    lua_setglobal(L, name);
  }
  lua_newtable(L);
  lua_pushstring(L, name);
  push_function<unknown_member, Charge::call>(L, 1);
  lua_setfield(L, -2, "__index");
  lua_setmetatable(L, -2);
  lua_pop(L, 1);
}

}  // namespace

void add_drawing_words(lua_State* L) {
  push(L, Drawing{});
  lua_setfield(L, LUA_REGISTRYINDEX, "verisim.drawing");
  push_metatable<Drawing>(L);
  for (const char* event : {"__index", "__call"}) set_function<drawing_call, Charge::call>(L, event);
  for (const char* event : {"__add", "__sub", "__mul", "__div", "__unm", "__concat"})
    set_function<drawing_arithmetic, Charge::call>(L, event);
  set_function<ignore_assignment, Charge::call>(L, "__newindex");
  set_function<drawing_text, Charge::call>(L, "__tostring");
  lua_pop(L, 1);

  add_words<ignored_word>(
      L, {"Geode", "TextGeode", "Font", "Light", "LightSource", "Lighting", "AmbientIntensity", "GlobalStateSet",
          "clearScene", "hideInView", "switchToMinimalRoom", "showBubble", "hideBubble", "setNavIndicatorPos"});
  add_words<drawing_group>(L, {"TransparentGroup", "Switch"});
  for (const char* name :
       {"osg", "osgText", "osgDB", "osgUtil", "osgSim", "osgnav", "osgLua", "RelativeTo", "snx", "vrjKernel"})
    accept_members(L, name);
}

}  // namespace verisim::script
