// Scripts that use other files: require, dofile, runfile, and VR JuggLua's model search path. All of it through Inputs,
// which keeps to the scenario's folder and records what was read.
#include <algorithm>
#include <array>

#include "engine/script/script_state.hpp"
#include "engine/script/values.hpp"

namespace verisim::script {
namespace {

// The folder part of a name, "." for none.
std::string folder_of(const std::string& name) {
  const std::size_t slash = name.find_last_of('/');
  return slash == std::string::npos ? "." : name.substr(0, slash);
}

std::string below(const std::string& folder, const std::string& name) {
  return folder == "." ? name : folder + "/" + name;
}

/// The path of a script or model: as named, or in a folder of the search path. Empty if not found.
std::string find_file(lua_State* L, const std::string& name) {
  ScriptState& state = ScriptState::of(L);
  if (state.has_file(L, name)) return name;
  for (const std::string& folder : state.search_path)
    if (state.has_file(L, below(folder, name))) return below(folder, name);
  return {};
}

// The script that calls, `depth` calls further out: the name that Inputs knows it by.
std::string calling_script(lua_State* L, int depth) {
  lua_Debug record;
  for (int level = 1; lua_getstack(L, level, &record) != 0; ++level) {
    lua_getinfo(L, "S", &record);
    Sandbox::charge(L, 10 + static_cast<std::uint64_t>(level));  // each level is counted from the first
    if (record.source[0] == '@' && depth-- <= 0) return record.source + 1;
  }
  return Sandbox::of(L).name();
}

int get_script_filename(lua_State* L) {
  const double depth = lua_isnoneornil(L, 1) ? 0 : number_at(L, 1, "getScriptFilename: the depth");
  push_text(L, calling_script(L, static_cast<int>(std::clamp(depth, 0.0, 1000.0))));
  return 1;
}

constexpr std::size_t kFoldersMax = 100;  // each look-up goes through all

void append_folder(ScriptState& state, const std::string& folder) {
  auto& path = state.search_path;
  if (std::find(path.begin(), path.end(), folder) != path.end()) return;
  if (path.size() >= kFoldersMax) fail(ErrorKind::input, "the model search path has {} folders already", kFoldersMax);
  path.push_back(folder);
}

// A file's name stands for its folder, as VR JuggLua has it.
int append_to_search_path(lua_State* L) {
  ScriptState& state = ScriptState::of(L);
  const std::string name = text_at(L, 1, "vrjLua.appendToModelSearchPath: the folder");
  append_folder(state, state.has_file(L, name) ? folder_of(name) : name);
  return 0;
}

int search_path(lua_State* L) {
  push_text(L, fmt::format("{}", fmt::join(ScriptState::of(L).search_path, ";")));
  return 1;
}

int find_in_search_path(lua_State* L) {
  const std::string name = text_at(L, 1, "vrjLua.findInModelSearchPath: the file");
  const std::string found = find_file(L, name);
  push_text(L, found.empty() ? name : found);  // as it stands: whoever opens it says what is wrong with it
  return 1;
}

int add_app_directory(lua_State* L) {
  append_folder(ScriptState::of(L), folder_of(calling_script(L, 0)));
  return 0;
}

int run_named_file(lua_State* L) {
  ScriptState& state = ScriptState::of(L);
  const std::string name = text_at(L, 1, "runfile: the file");
  std::string found = find_file(L, name);
  if (found.empty()) found = find_file(L, name + ".lua");
  if (found.empty()) raise(L, "Could not find {} in model search path to run!", name);
  state.print(fmt::format("Running {} - found at {}", name, found));
  return state.run_file(L, found);
}

int do_file(lua_State* L) {
  return ScriptState::of(L).run_file(L, text_at(L, 1, "dofile: the file"));
}

constexpr std::array<const char*, 6> kOwnModules = {"Actions", "AddAppDirectory",  "getScriptFilename",
                                                    "help",    "TransparentGroup", "Text"};

// require "NAME": words that are there already, or NAME.lua of the scenario's folder, run once.
int require_module(lua_State* L) {
  ScriptState& state = ScriptState::of(L);
  const std::string name = text_at(L, 1, "require: the module");
  if (std::find(kOwnModules.begin(), kOwnModules.end(), name) != kOwnModules.end()) {
    lua_getglobal(L, name.c_str());
    return 1;
  }
  lua_getfield(L, LUA_REGISTRYINDEX, "verisim.modules");
  lua_getfield(L, -1, name.c_str());
  if (!lua_isnil(L, -1)) return 1;
  std::string file = name;
  std::replace(file.begin(), file.end(), '.', '/');
  const std::string found = find_file(L, file + ".lua");
  if (found.empty())
    raise(L, "require: there is no module '{}': no {}.lua in the scenario's folder, and not one of {}", name, file,
          fmt::join(kOwnModules, ", "));
  const int results = state.run_file(L, found);
  if (results == 0)
    lua_pushboolean(L, 1);
  else
    lua_pop(L, results - 1);
  if (lua_isnil(L, -1)) {
    lua_pop(L, 1);
    lua_pushboolean(L, 1);
  }
  lua_getfield(L, LUA_REGISTRYINDEX, "verisim.modules");
  lua_pushvalue(L, -2);
  lua_setfield(L, -2, name.c_str());
  lua_pop(L, 1);
  return 1;
}

int help(lua_State* L) {
  ScriptState::of(L).print("The words of scenarios: engine/script/WORDS.md");
  return 0;
}

}  // namespace

void add_file_words(lua_State* L) {
  lua_newtable(L);
  lua_setfield(L, LUA_REGISTRYINDEX, "verisim.modules");
  set_global<require_module, Charge::call>(L, "require");
  set_global<do_file, Charge::call>(L, "dofile");
  set_global<run_named_file, Charge::call>(L, "runfile");
  set_global<add_app_directory, Charge::call>(L, "AddAppDirectory");
  set_global<get_script_filename, Charge::call>(L, "getScriptFilename");
  set_global<help, Charge::call>(L, "help");
  lua_newtable(L);
  set_function<append_to_search_path, Charge::call>(L, "appendToModelSearchPath");
  set_function<search_path, Charge::call>(L, "getModelSearchPath");
  set_function<find_in_search_path, Charge::call>(L, "findInModelSearchPath");
  set_function<no_effect, Charge::call>(L, "appendToLuaRequirePath");
  lua_getglobal(L, "print");
  lua_setfield(L, -2, "safePrint");
  lua_setglobal(L, "vrjLua");
}

}  // namespace verisim::script
