// string.find, match, gmatch, gsub and rep, rewritten so that no call runs longer than its allowance (lua_pattern.hpp).
// Arguments, results and errors as in the Lua 5.1 manual, section 5.4.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <string_view>

#include "engine/script/lua_pattern.hpp"
#include "engine/script/sandbox.hpp"
#include "engine/script/values.hpp"

namespace verisim::script {
namespace {

constexpr std::uint64_t kStepsMax = 10'000'000;  // about 0.1 s

std::string_view string_at(lua_State* L, int index) {
  std::size_t size = 0;
  const char* data = luaL_checklstring(L, index, &size);
  return {data, size};
}

// Where a search begins: positions count from 1, negative ones from the end.
std::ptrdiff_t start_offset(lua_State* L, int index, std::size_t size) {
  const double given = luaL_optnumber(L, index, 1);
  const auto length = static_cast<double>(size);
  const double start = given < 0 ? std::max(0.0, length + given) : std::max(0.0, given - 1);
  return static_cast<std::ptrdiff_t>(std::min(start, length));
}

void push_capture(lua_State* L, std::string_view subject, const PatternMatcher::Capture& capture) {
  if (capture.length == PatternMatcher::kUnclosed) raise(L, "malformed pattern ('(' without ')')");
  if (capture.length == PatternMatcher::kPosition)
    lua_pushnumber(L, static_cast<double>(capture.start + 1));
  else
    push_text(L, subject.substr(static_cast<std::size_t>(capture.start), static_cast<std::size_t>(capture.length)));
}

// All captures, or the whole match if the pattern has none.
int push_captures(lua_State* L, std::string_view subject, const PatternMatcher& matcher, std::ptrdiff_t start,
                  std::ptrdiff_t end) {
  const auto& captures = matcher.captures();
  if (captures.empty()) {
    push_text(L, subject.substr(static_cast<std::size_t>(start), static_cast<std::size_t>(end - start)));
    return 1;
  }
  luaL_checkstack(L, static_cast<int>(captures.size()), "too many captures");
  for (const auto& capture : captures) push_capture(L, subject, capture);
  return static_cast<int>(captures.size());
}

struct Found {
  std::ptrdiff_t start = -1;
  std::ptrdiff_t end = -1;
  [[nodiscard]] bool any() const { return start >= 0; }
};

Found search(PatternMatcher& matcher, std::string_view subject, std::ptrdiff_t from) {
  for (std::ptrdiff_t start = from; start <= static_cast<std::ptrdiff_t>(subject.size()); ++start) {
    const std::ptrdiff_t end = matcher.match_at(start);
    if (end >= 0) return {start, end};
    if (matcher.anchored()) break;
  }
  return {};
}

int find_plainly(lua_State* L, std::string_view subject, std::string_view wanted, std::ptrdiff_t from) {
  const std::string_view searched = subject.substr(static_cast<std::size_t>(from));
  // memmem takes linear time (two-way search), unlike string_view's find.
  const auto* found = static_cast<const char*>(memmem(searched.data(), searched.size(), wanted.data(), wanted.size()));
  const std::size_t gone_through =
      found == nullptr ? searched.size() : static_cast<std::size_t>(found - searched.data());
  Sandbox::charge(L, gone_through + wanted.size());
  if (found == nullptr) {
    lua_pushnil(L);
    return 1;
  }
  const auto at = static_cast<double>(found - subject.data());
  lua_pushnumber(L, at + 1);
  lua_pushnumber(L, at + static_cast<double>(wanted.size()));
  return 2;
}

int find_or_match(lua_State* L, bool find) {
  const std::string_view subject = string_at(L, 1);
  const std::string_view pattern = string_at(L, 2);
  const std::ptrdiff_t from = start_offset(L, 3, subject.size());
  Sandbox::charge(L, pattern.size());  // read here and, at worst, in its first step
  const bool plain =
      find && (lua_toboolean(L, 4) != 0 || pattern.find_first_of("^$*+?.([%-") == std::string_view::npos);
  if (plain) return find_plainly(L, subject, pattern, from);
  PatternMatcher matcher(subject, pattern, kStepsMax);
  const Found found = search(matcher, subject, from);
  raise_if_spent(L);
  if (!found.any()) {
    lua_pushnil(L);
    return 1;
  }
  if (!find) return push_captures(L, subject, matcher, found.start, found.end);
  lua_pushnumber(L, static_cast<double>(found.start + 1));
  lua_pushnumber(L, static_cast<double>(found.end));
  return 2 + (matcher.captures().empty() ? 0 : push_captures(L, subject, matcher, found.start, found.end));
}

int find(lua_State* L) {
  return find_or_match(L, true);
}
int match(lua_State* L) {
  return find_or_match(L, false);
}

// Upvalues: subject, pattern, offset at which the next search begins.
int next_match(lua_State* L) {
  const std::string_view subject = string_at(L, lua_upvalueindex(1));
  const std::string_view pattern = string_at(L, lua_upvalueindex(2));
  const auto from = static_cast<std::ptrdiff_t>(lua_tonumber(L, lua_upvalueindex(3)));
  PatternMatcher matcher(subject, pattern, kStepsMax);
  if (matcher.anchored()) return 0;  // '^' would make every step begin at the same place
  const Found found = search(matcher, subject, from);
  raise_if_spent(L);
  if (!found.any()) return 0;
  lua_pushnumber(L, static_cast<double>(found.end == found.start ? found.end + 1 : found.end));
  lua_replace(L, lua_upvalueindex(3));
  return push_captures(L, subject, matcher, found.start, found.end);
}

int gmatch(lua_State* L) {
  string_at(L, 1);
  string_at(L, 2);
  lua_settop(L, 2);
  lua_pushnumber(L, 0);
  push_function<next_match, Charge::own>(L, 3);
  return 1;
}

// Adds what stands for one match: a text with %0 … %9, or the result of a look-up or call.
void add_replacement(lua_State* L, std::string& result, std::string_view subject, const PatternMatcher& matcher,
                     Found found) {
  const int top = lua_gettop(L);
  const std::string_view whole =
      subject.substr(static_cast<std::size_t>(found.start), static_cast<std::size_t>(found.end - found.start));
  if (lua_isfunction(L, 3)) {
    lua_pushvalue(L, 3);
    const int count = push_captures(L, subject, matcher, found.start, found.end);
    lua_call(L, count, 1);
  } else if (lua_istable(L, 3)) {
    push_captures(L, subject, matcher, found.start, found.end);
    lua_settop(L, top + 1);
    lua_gettable(L, 3);
  } else {
    const std::string_view text = string_at(L, 3);
    Sandbox::charge(L, text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text[i] != '%' || i + 1 == text.size()) {
        result += text[i];
        continue;
      }
      const char c = text[++i];
      const auto index = static_cast<std::size_t>(c - '1');
      if (c == '0' || (c == '1' && matcher.captures().empty())) {
        result += whole;
      } else if (c < '1' || c > '9') {
        result += c;
      } else if (index >= matcher.captures().size()) {
        raise(L, "invalid capture index %{} in the replacement", c);
      } else {
        push_capture(L, subject, matcher.captures()[index]);
        result += string_at(L, -1);
      }
    }
    lua_settop(L, top);
    return;
  }
  if (lua_toboolean(L, -1) == 0)
    result += whole;
  else if (lua_isstring(L, -1) != 0)
    result += string_at(L, -1);
  else
    raise(L, "invalid replacement value (a {})", luaL_typename(L, -1));
  lua_settop(L, top);
}

int gsub(lua_State* L) {
  const std::string_view subject = string_at(L, 1);
  const std::string_view pattern = string_at(L, 2);
  const int type = lua_type(L, 3);
  if (type != LUA_TSTRING && type != LUA_TNUMBER && type != LUA_TTABLE && type != LUA_TFUNCTION)
    raise(L, "string.gsub: the replacement must be a text, table or function, not a {}", luaL_typename(L, 3));
  const double replaced_max = luaL_optnumber(L, 4, static_cast<double>(subject.size()) + 1);
  lua_settop(L, 3);
  PatternMatcher matcher(subject, pattern, kStepsMax);
  std::string result;
  const auto size = static_cast<std::ptrdiff_t>(subject.size());
  double replaced = 0;
  std::ptrdiff_t s = 0;
  std::size_t charged = 0;
  while (replaced < replaced_max) {
    const std::ptrdiff_t end = matcher.match_at(s);
    if (end >= 0) {
      ++replaced;
      add_replacement(L, result, subject, matcher, {s, end});
      Sandbox::charge(L, (result.size() - std::min(charged, result.size())) / 8);
      charged = result.size();
      // Not Lua's memory: what a script may hold outside its limit is bounded (64 MB, this text twice while it grows).
      constexpr std::size_t kLongest = std::size_t{16} << 20;
      if (result.size() > kLongest) raise(L, "string.gsub: the result is longer than 16 MiB");
    }
    if (end > s)
      s = end;
    else if (s < size)
      result += subject[static_cast<std::size_t>(s++)];
    else
      break;
    if (matcher.anchored()) break;
  }
  if (s < size) result += subject.substr(static_cast<std::size_t>(s));
  raise_if_spent(L);
  push_text(L, result);
  lua_pushnumber(L, replaced);
  return 2;
}

int repeat(lua_State* L) {
  const std::string_view text = string_at(L, 1);
  const double count = std::max(0.0, std::floor(luaL_checknumber(L, 2)));
  const double size = count * static_cast<double>(text.size());
  if (!(size <= 0x1p26)) raise(L, "string.rep: the result would be {:.0f} bytes long", size);
  if (text.empty() || count == 0) {
    lua_pushliteral(L, "");
    return 1;
  }
  Sandbox::charge(L, static_cast<std::uint64_t>(size) / 16);
  // Built in memory that counts against the limit, then copied once.
  const auto bytes = static_cast<std::size_t>(size);
  auto* const buffer = static_cast<char*>(lua_newuserdata(L, bytes));
  std::memcpy(buffer, text.data(), text.size());
  for (std::size_t filled = text.size(); filled < bytes; filled *= 2)
    std::memcpy(buffer + filled, buffer, std::min(filled, bytes - filled));
  lua_pushlstring(L, buffer, bytes);
  return 1;
}

}  // namespace

void open_strings(lua_State* L) {
  set_function<find, Charge::own>(L, "find");
  set_function<match, Charge::own>(L, "match");
  set_function<gmatch, Charge::own>(L, "gmatch");
  set_function<gmatch, Charge::own>(L, "gfind");  // its name in Lua 5.0, still there in 5.1
  set_function<gsub, Charge::own>(L, "gsub");
  set_function<repeat, Charge::own>(L, "rep");
  lua_pushnil(L);
  lua_setfield(L, -2, "dump");  // compiled Lua
}

}  // namespace verisim::script
