// Every function of C++ that a script can reach: from the globals, through metatables, upvalues and the values that
// words return.
#pragma once

#include <lua.hpp>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace verisim::script {

struct ReachedFunction {
  std::string path;  ///< "string.find"
  int reference;     ///< of the function, in Lua's registry
  lua_CFunction address;
};

/// Values whose metatables and members only exist once a word was called; a scene must be able to stand.
inline constexpr const char* kSampleValues = R"lua(
  local v, q = osg.Vec3(1, 2, 3), osg.Quat()
  local solid = Solid and Solid.box{0.01, 0.01, 0.01}
  return {
    v, v.x, q, osg.Matrix(), solid, solid and solid.translate, solid and solid.rotate, solid and Group{}.addChild,
    FeatureSet(), FeatureSet().insert, Plane(), BoundaryFeature(Plane()), osg.Material(), ("x"):gmatch("."),
    coroutine.wrap(function() end), coroutine.create(function() end), (pairs{[{}] = 1}), (pairs{}), (ipairs{}),
    Devices.Hand{ path = {{0, 0, 0}} }, Devices.Hand{ path = {{0, 0, 0}} }.getButtonState, Degrees, AngleAxis(1, Axis{0, 0, 1}),
  })lua";

class FunctionWalk {
 public:
  explicit FunctionWalk(lua_State* L) : L_(L) {
    lua_pushvalue(L, LUA_GLOBALSINDEX);
    visit("");
    lua_pushliteral(L, "");
    visit_metatable("text");
    lua_pop(L, 1);
    lua_pushvalue(L, LUA_REGISTRYINDEX);  // the metatables of userdata
    visit_types();
  }
  /// Adds what can be reached from the value on top of the stack, and pops it.
  void visit(const std::string& path) {
    luaL_checkstack(L_, 20, "values within values");
    const int type = lua_type(L_, -1);
    if ((type == LUA_TTABLE || type == LUA_TFUNCTION || type == LUA_TUSERDATA || type == LUA_TTHREAD) &&
        seen_.insert(lua_topointer(L_, -1)).second) {
      visit_metatable(path);
      if (type == LUA_TTABLE) visit_fields(path);
      if (type == LUA_TFUNCTION) visit_function(path);
    }
    lua_pop(L_, 1);
  }
  [[nodiscard]] const std::vector<ReachedFunction>& functions() const { return functions_; }

 private:
  static std::string joined(const std::string& path, const std::string& name) {
    return path.empty() ? name : path + "." + name;
  }
  void visit_metatable(const std::string& path) {
    if (lua_getmetatable(L_, -1) != 0) visit(joined(path, "(metatable)"));
  }
  void visit_fields(const std::string& path) {
    const int table = lua_gettop(L_);
    for (lua_pushnil(L_); lua_next(L_, table) != 0;) {
      const std::string name = lua_type(L_, -2) == LUA_TSTRING ? lua_tostring(L_, -2) : "[]";
      visit(joined(path, name));
    }
  }
  void visit_types() {
    const int registry = lua_gettop(L_);
    for (lua_pushnil(L_); lua_next(L_, registry) != 0;) {
      const bool type = lua_type(L_, -2) == LUA_TSTRING && lua_type(L_, -1) == LUA_TTABLE;
      const std::string name = type ? lua_tostring(L_, -2) : "";
      if (type && name.rfind("verisim.", 0) != 0 && name != "_LOADED" && name != "FILE*")
        visit(name);
      else
        lua_pop(L_, 1);
    }
    lua_pop(L_, 1);
  }
  void visit_function(const std::string& path) {
    if (lua_iscfunction(L_, -1) == 0) return;
    lua_pushvalue(L_, -1);
    functions_.push_back({path, luaL_ref(L_, LUA_REGISTRYINDEX), lua_tocfunction(L_, -1)});
    const std::string own = path;
    for (int i = 1; lua_getupvalue(L_, -1, i) != nullptr; ++i) {
      // An upvalue that is Lua's own function is called by the one above, never by a script.
      if (lua_iscfunction(L_, -1) != 0 && hidden_in(own))
        lua_pop(L_, 1);
      else
        visit(joined(own, "(upvalue)"));
    }
  }
  static bool hidden_in(const std::string& path) { return path.find("(metatable)") == std::string::npos; }

  lua_State* L_;
  std::set<const void*> seen_;
  std::vector<ReachedFunction> functions_;
};

}  // namespace verisim::script
