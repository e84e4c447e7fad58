#include "engine/script/values.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/error.hpp"
#include "engine/base/text.hpp"
#include "engine/script/script_state.hpp"

namespace verisim::script {

std::string described(lua_State* L, int index) {
  switch (lua_type(L, index)) {
    case LUA_TNONE:
    case LUA_TNIL:
      return "nothing";
    case LUA_TBOOLEAN:
      return lua_toboolean(L, index) != 0 ? "true" : "false";
    case LUA_TNUMBER:
      return fmt::format("{:g}", lua_tonumber(L, index));
    case LUA_TSTRING:
      return fmt::format("a text ('{}')", shown({lua_tostring(L, index), lua_objlen(L, index)}, 40));
    default:
      break;
  }
  if (lua_getmetatable(L, index) != 0) {
    lua_getfield(L, -1, "__metatable");
    const std::string name = lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : luaL_typename(L, index);
    lua_pop(L, 2);
    return "a " + name;
  }
  return std::string("a ") + luaL_typename(L, index);
}

int refuse_assignment(lua_State* L) {
  raise(L, "{}'s '{}' cannot be set", described(L, 1),
        lua_type(L, 2) == LUA_TSTRING ? text_at(L, 2, "a member") : described(L, 2));
}

double number_at(lua_State* L, int index, const std::string& what) {
  if (lua_type(L, index) != LUA_TNUMBER) raise(L, "{} must be a number, not {}", what, described(L, index));
  const double value = lua_tonumber(L, index);
  if (!std::isfinite(value)) raise(L, "{} is {} but must be finite; look for a division by zero", what, value);
  return value;
}

namespace {

std::string_view bytes_at(lua_State* L, int index, const std::string& what, std::size_t longest) {
  if (lua_type(L, index) != LUA_TSTRING) raise(L, "{} must be a text, not {}", what, described(L, index));
  std::size_t size = 0;
  const char* data = lua_tolstring(L, index, &size);
  if (size > longest) raise(L, "{} is {} bytes long; {} are allowed", what, size, longest);
  Sandbox::charge(L, size);
  return {data, size};
}

}  // namespace

std::string text_at(lua_State* L, int index, const std::string& what) {
  const std::string_view text = bytes_at(L, index, what, kLongestLine);
  const std::string fault = line_fault(text);
  if (!fault.empty()) raise(L, "{} {}: '{}'", what, fault, shown(text, 40));
  return std::string(text);
}

std::string name_at(lua_State* L, int index, const std::string& what) {
  const std::string_view text = bytes_at(L, index, what, kLongestText);
  const std::string fault = name_fault(text);
  if (!fault.empty()) raise(L, "{} {}: '{}'", what, fault, shown(text, 40));
  return std::string(text);
}

std::string recordable(lua_State* L, const std::string& what, const std::string& name) {
  std::string result = name;
  for (char& c : result)
    if (static_cast<unsigned char>(c) < 0x20 || c == '/' || c == '~') c = '_';
  if (result.empty() || result == ".") raise(L, "{} is '{}'; give a name of letters", what, name);
  if (result != name)
    ScriptState::of(L).notice(fmt::format("{}: {} '{}' is recorded as '{}'", where(L), what, name, result));
  return result;
}

std::string any_text_at(lua_State* L, int index, const std::string& what) {
  return std::string(bytes_at(L, index, what, kLongestText));
}

bool boolean_at(lua_State* L, int index, const std::string& what) {
  if (lua_type(L, index) != LUA_TBOOLEAN) raise(L, "{} must be true or false, not {}", what, described(L, index));
  return lua_toboolean(L, index) != 0;
}

namespace {

// The numbers 1 … count of a table of exactly that length.
void numbers_of_table(lua_State* L, int index, const std::string& what, const char* shape, double* values, int count) {
  if (lua_type(L, index) != LUA_TTABLE || lua_objlen(L, index) != static_cast<std::size_t>(count))
    raise(L, "{} must be {}, not {}", what, shape, described(L, index));
  const int table = index < 0 ? lua_gettop(L) + index + 1 : index;
  for (int i = 0; i < count; ++i) {
    lua_rawgeti(L, table, i + 1);
    values[i] = number_at(L, -1, fmt::format("{}[{}]", what, i + 1));
    lua_pop(L, 1);
  }
}

}  // namespace

Vector3d vector_at(lua_State* L, int index, const std::string& what) {
  if (const auto* vector = get_if<Vector3d>(L, index)) {
    if (!vector->allFinite()) raise(L, "{} has a component that is not finite", what);
    return *vector;
  }
  Vector3d vector;
  numbers_of_table(L, index, what, "three numbers {x, y, z} or an osg.Vec3", vector.data(), 3);
  return vector;
}

Quaterniond rotation_at(lua_State* L, int index, const std::string& what) {
  Quaterniond rotation;
  if (const auto* given = get_if<Quaterniond>(L, index))
    rotation = *given;
  else
    numbers_of_table(L, index, what, "a rotation: AngleAxis(angle, Axis{x, y, z}), an osg.Quat or {x, y, z, w}",
                     rotation.coeffs().data(), 4);
  const double length = rotation.norm();
  if (!(length > 1e-12) || !std::isfinite(length))
    raise(L, "{} is a quaternion of length {}: no rotation", what, length);
  return rotation.normalized();
}

int no_effect(lua_State* /*L*/) {
  return 0;
}

void push_text(lua_State* L, std::string_view text) {
  lua_pushlstring(L, text.data(), text.size());
}

std::string suggestion(const std::string& name, std::vector<std::string> known) {
  std::sort(known.begin(), known.end());
  known.erase(std::unique(known.begin(), known.end()), known.end());
  const std::string nearest = nearest_name(name, known);
  if (nearest.empty()) return fmt::format("; known: {}", fmt::join(known, ", "));
  return fmt::format("; did you mean '{}'? ({})", nearest, fmt::join(known, ", "));
}

Fields::Fields(lua_State* L, int index, std::string word) : L_(L), index_(index), word_(std::move(word)) {
  VERISIM_ASSERT(index > 0);  // reading a field moves the top
  VERISIM_ASSERT(!word_.empty());
  if (lua_type(L, index) != LUA_TTABLE)
    raise(L, "{0} is called with {1}; call it with a table: {0}{{ … }}", word_, described(L, index));
}

bool Fields::push(const char* name) {
  known_.emplace_back(name);
  lua_getfield(L_, index_, name);
  if (!lua_isnil(L_, -1)) return true;
  lua_pop(L_, 1);
  return false;
}

bool Fields::accepted(const char* name) {
  if (!push(name)) return false;
  lua_pop(L_, 1);
  return true;
}

std::optional<double> Fields::number(const char* name) {
  if (!push(name)) return std::nullopt;
  const double value = number_at(L_, -1, name_of(name));
  lua_pop(L_, 1);
  return value;
}

std::optional<double> Fields::positive(const char* name) {
  const std::optional<double> value = number(name);
  if (value && !(*value > 0)) raise(L_, "{} is {:g} but must be above 0", name_of(name), *value);
  return value;
}

double Fields::not_negative(const char* name, double otherwise) {
  const double value = number(name, otherwise);
  if (value < 0) raise(L_, "{} is {:g} but must not be negative", name_of(name), value);
  return value;
}

std::optional<std::string> Fields::text(const char* name) {
  if (!push(name)) return std::nullopt;
  std::string value = text_at(L_, -1, name_of(name));
  lua_pop(L_, 1);
  return value;
}

std::optional<std::string> Fields::name() {
  if (!push("name")) return std::nullopt;
  const std::string value = name_at(L_, -1, name_of("name"));
  lua_pop(L_, 1);
  return recordable(L_, name_of("name"), value);
}

std::optional<bool> Fields::boolean(const char* name) {
  if (!push(name)) return std::nullopt;
  const bool value = boolean_at(L_, -1, name_of(name));
  lua_pop(L_, 1);
  return value;
}

std::optional<Vector3d> Fields::vector(const char* name) {
  if (!push(name)) return std::nullopt;
  Vector3d value = vector_at(L_, -1, name_of(name));
  lua_pop(L_, 1);
  return value;
}

std::optional<Quaterniond> Fields::rotation(const char* name) {
  if (!push(name)) return std::nullopt;
  Quaterniond value = rotation_at(L_, -1, name_of(name));
  lua_pop(L_, 1);
  return value;
}

void Fields::finish(bool children_allowed) {
  constexpr std::size_t kUnknownMax = 100;
  std::vector<std::string> unknown;
  for (lua_pushnil(L_); lua_next(L_, index_) != 0; lua_pop(L_, 1)) {
    if (lua_type(L_, -2) == LUA_TNUMBER) {
      if (!children_allowed) raise(L_, "{} has an entry without a name: {}", word_, described(L_, -1));
    } else if (lua_type(L_, -2) != LUA_TSTRING) {
      raise(L_, "{} has a key that is a {}; keys are names", word_, luaL_typename(L_, -2));
    } else if (std::find(known_.begin(), known_.end(), lua_tostring(L_, -2)) == known_.end()) {
      if (unknown.size() < kUnknownMax)
        unknown.emplace_back(lua_tostring(L_, -2), std::min(lua_objlen(L_, -2), kLongestLine));
    }
  }
  if (unknown.empty()) return;
  std::sort(unknown.begin(), unknown.end());
  raise(L_, "{} has no '{}'{}", word_, shown(unknown.front(), 40), suggestion(unknown.front(), known_));
}

}  // namespace verisim::script
