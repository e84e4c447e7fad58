// What Lua calls in its archive's copy in place of the C library and of its own functions (CMakeLists.txt), so that the
// bytes that an instruction moves, compares or reads count as work. sin, pow and their like: lua_math.cpp; tables:
// lua_tables.cpp.
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <lua.hpp>
#include <string_view>

#include "engine/script/work.hpp"

using verisim::script::raise_if_spent;
using verisim::script::work;

namespace verisim::script {
thread_local constinit Work work;
}  // namespace verisim::script

union TString;
struct lua_TValue;

// Lua's own, renamed where they are defined.
TString* verisim_lua_newlstr(lua_State* L, const char* text, std::size_t size);
int verisim_lua_precall(lua_State* L, lua_TValue* function, int results);
int verisim_lua_poscall(lua_State* L, lua_TValue* first_result);

// What the rest of Lua finds in their places.
TString* luaS_newlstr(lua_State* L, const char* text, std::size_t size);
int luaD_precall(lua_State* L, lua_TValue* function, int results);
int luaD_poscall(lua_State* L, lua_TValue* first_result);

namespace {

constexpr std::uint64_t kTextWork = 8;           // to make a text, or find it among those that are there
constexpr std::uint64_t kConversionWork = 40;    // number to text
constexpr std::uint64_t kReadingWork = 20;       // text to number
constexpr std::size_t kLongestNumber = 1000;     // characters; a longer text is no number
constexpr std::size_t kLongestText = 64U << 20;  // bytes; bounds what one instruction can do

// --- lstate.h, lstring.h: as far as counting needs them
// ---------------------------------------------------------------

struct Collected {
  Collected* next;
};
struct TextTable {  // the begin of global_State
  Collected** lists;
  std::uint32_t used;
  int size;
};
struct StateHead {  // the begin of lua_State
  Collected* next;
  std::uint8_t type, marked, status;
  std::byte* top;
  std::byte* base;
  const TextTable* texts;
};
constexpr std::ptrdiff_t kValueSize = 16;

const StateHead& head_of(lua_State* L) {
  return *reinterpret_cast<const StateHead*>(L);
}

/// As luaS_newlstr computes it: of a long text, every so manieth byte.
std::uint32_t hash_of(const char* text, std::size_t size) {
  auto hash = static_cast<std::uint32_t>(size);
  const std::size_t step = (size >> 5) + 1;
  for (std::size_t i = size; i >= step; i -= step)
    hash = hash ^ ((hash << 5) + (hash >> 2) + static_cast<unsigned char>(text[i - 1]));
  return hash;
}

/// Lua compares a text with all that stand in its list; a list is short unless its texts are made to collide.
std::uint64_t texts_in_list(lua_State* L, const char* text, std::size_t size) {
  const TextTable& texts = *head_of(L).texts;
  if (texts.size == 0) return 0;
  std::uint64_t count = 0;
  const Collected* collected = texts.lists[hash_of(text, size) & static_cast<std::uint32_t>(texts.size - 1)];
  for (; collected != nullptr; collected = collected->next) ++count;
  constexpr std::uint64_t kFree = 32;  // names of files may differ from run to run
  return count > kFree ? count : 0;
}

/// What Lua writes down of an error that it has just caught. Nothing protects it there: an error would end the program.
bool is_of_caught_error(std::string_view text) {
  return text == "not enough memory" || text == "error in error handling";
}

void count_values(std::int64_t values) {
  constexpr std::int64_t kFew = 16;
  if (values > kFew) work.used += static_cast<std::uint64_t>(values) / 2;
}

std::int64_t values_above(lua_State* L, const lua_TValue* from) {
  return (head_of(L).top - reinterpret_cast<const std::byte*>(from)) / kValueSize;
}

}  // namespace

TString* luaS_newlstr(lua_State* L, const char* text, std::size_t size) {
  work.used += kTextWork + size / 8 + texts_in_list(L, text, size);
  if (!is_of_caught_error({text, size})) raise_if_spent(L);
  if (size > kLongestText)
    luaL_error(L, "a text of %d MiB is longer than a text may be (64 MiB)", static_cast<int>(size >> 20));
  return verisim_lua_newlstr(L, text, size);
}

int luaD_precall(lua_State* L, lua_TValue* function, int results) {
  count_values(values_above(L, function) - 1);
  raise_if_spent(L);
  return verisim_lua_precall(L, function, results);
}

int luaD_poscall(lua_State* L, lua_TValue* first_result) {
  count_values(values_above(L, first_result));
  return verisim_lua_poscall(L, first_result);
}

extern "C" {

// Lua's own is called by table.sort alone.
int verisim_lua_plain_lessthan(lua_State* L, int a, int b);
int lua_lessthan(lua_State* L, int a, int b) {
  work.used += 4;
  raise_if_spent(L);
  return verisim_lua_plain_lessthan(L, a, b);
}

void* verisim_lua_memcpy(void* to, const void* from, std::size_t size) {
  work.used += size / 32;
  return std::memcpy(to, from, size);
}

int verisim_lua_memcmp(const void* a, const void* b, std::size_t size) {
  work.used += 1 + size / 32;
  return std::memcmp(a, b, size);
}

const void* verisim_lua_memchr(const void* text, int c, std::size_t size) {
  work.used += 1 + size / 32;
  return std::memchr(text, c, size);
}

std::size_t verisim_lua_strlen(const char* text) {
  const std::size_t size = std::strlen(text);
  work.used += size / 32;
  return size;
}

const char* verisim_lua_strchr(const char* text, int c) {
  work.used += 1;
  return std::strchr(text, c);
}

const char* verisim_lua_strpbrk(const char* text, const char* wanted) {
  work.used += std::strlen(text) / 4;
  return std::strpbrk(text, wanted);
}

// By bytes, not by the locale's order.
int verisim_lua_strcoll(const char* a, const char* b) {
  constexpr std::size_t kBlock = 4096;
  while (true) {
    const int order = std::strncmp(a, b, kBlock);
    const std::size_t size = ::strnlen(a, kBlock);
    work.used += 1 + size / 16;
    if (order != 0 || size < kBlock) return order;
    a += kBlock;
    b += kBlock;
  }
}

double verisim_lua_strtod(const char* text, char** end) {
  const std::size_t size = ::strnlen(text, kLongestNumber + 1);
  work.used += kReadingWork + size;
  if (size <= kLongestNumber) return std::strtod(text, end);
  *end = const_cast<char*>(text);
  return 0;
}

unsigned long verisim_lua_strtoul(const char* text, char** end, int base) {
  const std::size_t size = ::strnlen(text, kLongestNumber + 1);
  work.used += kReadingWork + size;
  if (size <= kLongestNumber) return std::strtoul(text, end, base);
  *end = const_cast<char*>(text);
  return 0;
}

int verisim_lua_sprintf_chk(char* to, int /*flag*/, std::size_t size, const char* format, ...) {
  work.used += kConversionWork;
  va_list arguments;
  va_start(arguments, format);
  const int written = std::vsnprintf(to, size, format, arguments);
  va_end(arguments);
  return written;
}

}  // extern "C"
