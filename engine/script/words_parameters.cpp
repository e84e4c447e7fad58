// params{ clearance = 0.005, … }: what --set may change; parameter(0.005, "m", "on the radius") in it says more. And
// the small words: mm, deg, outcome, measure.
#include <algorithm>
#include <cmath>

#include "engine/base/json.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/base/text.hpp"
#include "engine/script/script_state.hpp"
#include "engine/script/values.hpp"

namespace verisim::script {
namespace {

constexpr int kNestingMax = 8;  // of lists in a parameter
constexpr std::size_t kParametersMax = 1000;

/// What all parameters together may take: lists that stand in each other make much of little.
class ParameterRoom {
 public:
  void take(lua_State* L, std::size_t bytes) {
    constexpr std::size_t kMost = std::size_t{1} << 20;
    Sandbox::charge(L, bytes);
    taken_ += bytes;
    if (taken_ > kMost) raise(L, "params: its values take more than {} bytes; read large data with dofile", kMost);
  }

 private:
  std::size_t taken_ = 0;
};

constexpr const char* kParameterKey = "verisim.parameter";  // of what parameter() gives

bool is_declared_parameter(lua_State* L, int index) {
  if (lua_type(L, index) != LUA_TTABLE || lua_getmetatable(L, index) == 0) return false;
  lua_getfield(L, LUA_REGISTRYINDEX, kParameterKey);
  const bool same = lua_rawequal(L, -1, -2) != 0;
  lua_pop(L, 2);
  return same;
}

Json to_json(lua_State* L, ParameterRoom& room, int index, const std::string& what, int depth = 0) {
  room.take(L, 32);
  switch (lua_type(L, index)) {
    case LUA_TBOOLEAN:
      return lua_toboolean(L, index) != 0;
    case LUA_TNUMBER:
      return number_at(L, index, what);
    case LUA_TSTRING: {
      std::string text = any_text_at(L, index, what);
      const std::string fault = value_fault(text);
      if (!fault.empty()) raise(L, "{} {}: '{}'", what, fault, shown(text, 40));
      room.take(L, text.size());
      return text;
    }
    case LUA_TTABLE:
      break;
    default:
      raise(L, "{} must be a number, a text, true or false, or a list of these, not {}", what, described(L, index));
  }
  if (is_declared_parameter(L, index)) raise(L, "{}: parameter(…) is a whole default, not part of one", what);
  if (depth == kNestingMax) raise(L, "{} is nested more than {} deep", what, kNestingMax);
  Json list = Json::array();
  const auto length = static_cast<int>(lua_objlen(L, index));
  for (int i = 1; i <= length; ++i) {
    lua_rawgeti(L, index, i);
    list.push_back(to_json(L, room, lua_gettop(L), fmt::format("{}[{}]", what, i), depth + 1));
    lua_pop(L, 1);
  }
  return list;
}

bool is_bare_word(const std::string& text) {
  return !text.empty() && std::isalpha(static_cast<unsigned char>(text[0])) != 0 &&
         text.find_first_of("()\"'{}[]=") == std::string::npos && text != "true" && text != "false";
}

// A --set error is the command line's, not that of the line of the script: no place before it.
[[noreturn]] void raise_for_command_line(lua_State* L, const std::string& text) {
  push_text(L, text);
  lua_error(L);
  std::abort();  // lua_error does not return
}

// Leaves the value of `--set key=text` on the stack. A text parameter takes its text as it stands, unless that is
// quoted; a number may have a unit.
void push_set_value(lua_State* L, const std::string& key, const std::string& text, int default_type) {
  const bool quoted = !text.empty() && (text[0] == '"' || text[0] == '\'');
  if (default_type == LUA_TSTRING && !quoted) {
    push_text(L, text);
    return;
  }
  if (default_type == LUA_TNUMBER) {
    if (const std::optional<double> value = number_with_unit(text)) {
      lua_pushnumber(L, *value);
      return;
    }
  }
  Sandbox& sandbox = Sandbox::of(L);
  const std::string place = fmt::format("{} {}={}", ScriptState::of(L).set_option, key, text);
  if (const auto failure = sandbox.load(L, place, "return " + text)) {
    if (!is_bare_word(text))
      raise_for_command_line(L,
                             fmt::format("{}: this is no Lua expression; a number like 0.005, 5mm or mm(5) is", place));
    push_text(L, text);
    return;
  }
  const auto failure = sandbox.call(L, 0, 1);
  if (failure) raise_for_command_line(L, failure->text);
  if (lua_isnil(L, -1) && is_bare_word(text)) {
    lua_pop(L, 1);
    push_text(L, text);
  }
}

std::string names_hint(const ScriptState& state, const std::string& key) {
  return suggestion(key, state.parameter_names);
}

void check_name(lua_State* L, const ScriptState& state, const std::string& key, const std::string& value) {
  const auto& names = state.parameter_names;
  if (std::find(names.begin(), names.end(), key) == names.end())
    raise_for_command_line(L, fmt::format("{} {}={}: {} has no parameter '{}'{}", state.set_option, key, value,
                                          state.name(), key, names_hint(state, key)));
}

// Leaves the value of `--set key=text` on the stack: of the type of the parameter's default.
void push_checked_value(lua_State* L, const ScriptState& state, const std::string& key, const std::string& text,
                        int type) {
  push_set_value(L, key, text, type);
  if (lua_type(L, -1) != type)
    raise_for_command_line(
        L, fmt::format("{} {}={}: '{}' must be a {}, as its default at {} is, not {}", state.set_option, key, text, key,
                       lua_typename(L, type), *state.parameters_place, described(L, -1)));
}

// parameter(0.005, "m", "on the radius"): a default that says its unit and what it means, for params{} alone.
int declare_one(lua_State* L) {
  if (lua_isnoneornil(L, 1))
    raise(L, "parameter: its default is nothing; write parameter(0.005, \"m\", \"on the radius\")");
  const std::string unit = lua_isnoneornil(L, 2) ? "" : name_at(L, 2, "parameter: the unit");
  const std::string meaning = lua_isnoneornil(L, 3) ? "" : name_at(L, 3, "parameter: the meaning");
  lua_settop(L, 1);
  lua_newtable(L);
  lua_pushvalue(L, 1);
  lua_setfield(L, -2, "default");
  push_text(L, unit);
  lua_setfield(L, -2, "unit");
  push_text(L, meaning);
  lua_setfield(L, -2, "meaning");
  lua_getfield(L, LUA_REGISTRYINDEX, kParameterKey);
  lua_setmetatable(L, -2);
  return 1;
}

std::string text_of_field(lua_State* L, int index, const char* name) {
  lua_getfield(L, index, name);
  std::string text = any_text_at(L, lua_gettop(L), fmt::format("parameter: {}", name));
  lua_pop(L, 1);
  return text;
}

// Puts the defaults in the places of what parameter() gave. The table of defaults is at index 2.
void take_declarations(lua_State* L, ScriptState& state) {
  for (const std::string& name : state.parameter_names) {
    ParameterDeclaration declared{.name = name, .type = {}, .value_json = {}, .unit = {}, .meaning = {}};
    lua_getfield(L, 2, name.c_str());
    if (is_declared_parameter(L, lua_gettop(L))) {
      declared.unit = text_of_field(L, lua_gettop(L), "unit");
      declared.meaning = text_of_field(L, lua_gettop(L), "meaning");
      lua_getfield(L, -1, "default");
      lua_setfield(L, 2, name.c_str());
    }
    lua_pop(L, 1);
    state.parameters.push_back(std::move(declared));
  }
}

// params{…}: argument 1 is `params` itself (called through its metatable), argument 2 the defaults.
int declare_parameters(lua_State* L) {
  ScriptState& state = ScriptState::of(L);
  if (lua_type(L, 2) != LUA_TTABLE)
    raise(L, "params is called with {}; call it with a table: params{{ clearance = 0.005 }}", described(L, 2));
  if (state.parameters_place)
    raise(L, "params was declared at {} already; put all parameters there", *state.parameters_place);
  state.parameters_place = where(L);
  for (lua_pushnil(L); lua_next(L, 2) != 0; lua_pop(L, 1)) {
    if (lua_type(L, -2) != LUA_TSTRING) raise(L, "params has an entry without a name: {}", described(L, -1));
    if (state.parameter_names.size() >= kParametersMax) raise(L, "params has more than {} entries", kParametersMax);
    state.parameter_names.push_back(name_at(L, -2, "params: the name of an entry"));
  }
  std::sort(state.parameter_names.begin(), state.parameter_names.end());
  take_declarations(L, state);
  for (const auto& [key, value] : state.options.sets) check_name(L, state, key, value);
  for (const auto& [key, value] : state.options.sets) {
    lua_getfield(L, 2, key.c_str());
    push_checked_value(L, state, key, value, lua_type(L, -1));
    lua_setfield(L, 2, key.c_str());
    lua_pop(L, 1);
  }
  ParameterRoom room;
  Json json = Json::object();
  for (ParameterDeclaration& declared : state.parameters) {
    const std::string& name = declared.name;
    lua_getfield(L, 2, name.c_str());
    json[name] = to_json(L, room, lua_gettop(L), "params: " + name);
    declared.type = lua_typename(L, lua_type(L, -1));
    declared.value_json = json_text(json[name]);
    lua_pushvalue(L, -1);
    lua_setfield(L, 1, name.c_str());
    lua_pop(L, 1);
  }
  state.parameters_json = json_text(json);
  state.parameters_known = true;
  if (state.parameters_only) raise_for_command_line(L, "the parameters are known: the script ends here");
  lua_settop(L, 1);
  return 1;
}

// (key, text) -> the value as JSON. For C++ alone.
int set_value_as_json(lua_State* L) {
  const ScriptState& state = ScriptState::of(L);
  const std::string key = any_text_at(L, 1, "the key"), text = any_text_at(L, 2, "the value");
  check_name(L, state, key, text);
  const auto declared = std::find_if(state.parameters.begin(), state.parameters.end(),
                                     [&](const ParameterDeclaration& p) { return p.name == key; });
  int type = LUA_TNUMBER;
  for (const int known : {LUA_TSTRING, LUA_TBOOLEAN, LUA_TTABLE})
    if (declared->type == lua_typename(L, known)) type = known;
  push_checked_value(L, state, key, text, type);
  ParameterRoom room;
  push_text(L, json_text(to_json(L, room, lua_gettop(L), fmt::format("{} {}", state.set_option, key))));
  return 1;
}

int unknown_parameter(lua_State* L) {
  const ScriptState& state = ScriptState::of(L);
  const std::string key = text_at(L, 2, "the name of a parameter");
  raise(L, "there is no parameter '{}'{}", key, names_hint(state, key));
}

int millimetres(lua_State* L) {
  lua_pushnumber(L, number_at(L, 1, "mm: the length") / 1000);
  return 1;
}

int degrees(lua_State* L) {
  lua_pushnumber(L, number_at(L, 1, "deg: the angle") * (pinned::kPi / 180));
  return 1;
}

// outcome("inserted") or outcome("inserted", { stop = true })
int say_outcome(lua_State* L) {
  ScriptState& state = ScriptState::of(L);
  const std::string said = name_at(L, 1, "outcome: the word");
  if (lua_gettop(L) > 1) {
    Fields fields(L, 2, "outcome");
    const bool stop = fields.boolean("stop").value_or(false);
    fields.finish(false);
    if (stop) state.stop();
  }
  Sandbox::charge(L, state.outcome != said ? kEventWork : 1);
  if (state.outcome == said) return 0;
  state.event("outcome", said);
  state.outcome = said;
  state.outcome_since = state.time();
  return 0;
}

// The last value of a name counts.
int say_measure(lua_State* L) {
  ScriptState& state = ScriptState::of(L);
  Measure measure{
      .name = name_at(L, 1, "measure: the name"), .value = number_at(L, 2, "measure: the value"), .unit = "1"};
  if (!lua_isnoneornil(L, 3)) measure.unit = name_at(L, 3, "measure: the unit");
  Sandbox::charge(L, 10 + state.measures.size());
  for (Measure& known : state.measures) {
    if (known.name != measure.name) continue;
    if (known.unit != measure.unit)
      raise(L, "measure '{}' had the unit '{}' and now has '{}'", measure.name, known.unit, measure.unit);
    known = measure;
    return 0;
  }
  if (state.measures.size() >= kMeasuresMax) raise(L, "measure: there are {} measures already", kMeasuresMax);
  state.measures.push_back(std::move(measure));
  return 0;
}

// event("passed", "the pin is through"): a line of /events.
int say_event(lua_State* L) {
  ScriptState& state = ScriptState::of(L);
  Sandbox::charge(L, kEventWork);
  const std::string kind = name_at(L, 1, "event: the kind");
  if (kind.empty()) raise(L, "event: the kind is an empty text; name what happened in a word or two");
  state.event(kind, any_text_at(L, 2, "event: the text"));
  return 0;
}

}  // namespace

std::string read_set_value(ScriptState& state, const std::string& key, const std::string& text) {
  lua_State* L = state.lua();
  push_function<set_value_as_json, Charge::call>(L);
  push_text(L, key);
  push_text(L, text);
  if (const auto failure = state.call(L, 2, 1)) throw Error(ErrorKind::input, failure->text);
  std::string json = lua_tostring(L, -1);
  lua_pop(L, 1);
  return json;
}

void add_parameter_words(lua_State* L) {
  lua_newtable(L);
  lua_pushstring(L, "parameter");
  lua_setfield(L, -2, "__metatable");
  lua_setfield(L, LUA_REGISTRYINDEX, kParameterKey);
  set_global<declare_one, Charge::call>(L, "parameter");
  lua_newtable(L);
  lua_newtable(L);
  set_function<declare_parameters, Charge::call>(L, "__call");
  set_function<unknown_parameter, Charge::call>(L, "__index");
  lua_setmetatable(L, -2);
  lua_setglobal(L, "params");
  set_global<millimetres, Charge::call>(L, "mm");
  set_global<degrees, Charge::call>(L, "deg");
  set_global<say_outcome, Charge::call>(L, "outcome");
  set_global<say_measure, Charge::call>(L, "measure");
  set_global<say_event, Charge::call>(L, "event");
}

}  // namespace verisim::script
