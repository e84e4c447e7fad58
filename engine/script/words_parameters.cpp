// params{ clearance = 0.005, … }: what --set may change. And the small words: mm, deg, outcome, measure.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

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

nlohmann::json to_json(lua_State* L, ParameterRoom& room, int index, const std::string& what, int depth = 0) {
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
  if (depth == kNestingMax) raise(L, "{} is nested more than {} deep", what, kNestingMax);
  nlohmann::json list = nlohmann::json::array();
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
// quoted.
void push_set_value(lua_State* L, const std::string& key, const std::string& text, int default_type) {
  const bool quoted = !text.empty() && (text[0] == '"' || text[0] == '\'');
  if (default_type == LUA_TSTRING && !quoted) {
    push_text(L, text);
    return;
  }
  Sandbox& sandbox = Sandbox::of(L);
  const std::string place = fmt::format("--set {}={}", key, text);
  if (const auto failure = sandbox.load(L, place, "return " + text)) {
    if (!is_bare_word(text))
      raise_for_command_line(L, fmt::format("{}: this is no Lua expression; a number like 0.005 or mm(5) is", place));
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

void check_names(lua_State* L, const ScriptState& state) {
  for (const auto& [key, value] : state.options.sets) {
    const auto& names = state.parameter_names;
    if (std::find(names.begin(), names.end(), key) == names.end())
      raise_for_command_line(L, fmt::format("--set {}={}: {} has no parameter '{}'{}", key, value, state.name(), key,
                                            names_hint(state, key)));
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
  check_names(L, state);
  for (const auto& [key, value] : state.options.sets) {
    lua_getfield(L, 2, key.c_str());
    const int type = lua_type(L, -1);
    push_set_value(L, key, value, type);
    if (lua_type(L, -1) != type)
      raise_for_command_line(
          L, fmt::format("--set {}={}: '{}' must be a {}, as its default at {} is, not {}", key, value, key,
                         lua_typename(L, type), *state.parameters_place, described(L, -1)));
    lua_setfield(L, 2, key.c_str());
    lua_pop(L, 1);
  }
  ParameterRoom room;
  nlohmann::json json = nlohmann::json::object();
  for (const std::string& name : state.parameter_names) {
    lua_getfield(L, 2, name.c_str());
    json[name] = to_json(L, room, lua_gettop(L), "params: " + name);
    lua_pushvalue(L, -1);
    lua_setfield(L, 1, name.c_str());
    lua_pop(L, 1);
  }
  state.parameters_json = json.dump();
  lua_settop(L, 1);
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
  if (state.outcome != said) state.event("outcome", said);
  state.outcome = said;
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

void add_parameter_words(lua_State* L) {
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
