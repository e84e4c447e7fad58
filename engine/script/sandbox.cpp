#include "engine/script/sandbox.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <vector>

#include "engine/base/error.hpp"

namespace verisim::script {
namespace {

constexpr int kHookInterval = 1000;        // instructions between two looks at the allowance
constexpr std::size_t kBytesPerUnit = 64;  // memory moved in about the time of one instruction
constexpr std::size_t kMebibyte = std::size_t{1} << 20;

std::string global_suggestion(lua_State* L, const std::string& text) {
  // Lua's own words for a call of a name that does not exist.
  constexpr std::string_view kBefore = "attempt to call global '";
  const std::size_t begin = text.find(kBefore);
  if (begin == std::string::npos) return {};
  const std::size_t name_begin = begin + kBefore.size();
  const std::string name = text.substr(name_begin, text.find('\'', name_begin) - name_begin);
  std::vector<std::string> known;
  for (lua_pushnil(L); lua_next(L, LUA_GLOBALSINDEX) != 0; lua_pop(L, 1))
    if (lua_type(L, -2) == LUA_TSTRING) known.emplace_back(lua_tostring(L, -2));
  std::sort(known.begin(), known.end());
  const std::string nearest = nearest_name(name, known);
  return nearest.empty() ? std::string{} : fmt::format("; did you mean '{}'?", nearest);
}

// True if a message begins with FILE:LINE: or with an option of the command line.
bool says_where(const std::string& text) {
  if (text.rfind("--", 0) == 0) return true;
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos || colon == 0) return false;
  const std::size_t end = text.find_first_not_of("0123456789", colon + 1);
  return end != std::string::npos && end > colon + 1 && text[end] == ':';
}

// Runs where the error happened: the stack still says which line that was.
int describe_error(lua_State* L) {
  if (lua_type(L, 1) != LUA_TSTRING) {
    const std::string kind = luaL_typename(L, 1);
    raise(L, "the script raised an error that is a {}, not a text", kind);
  }
  const std::string text = lua_tostring(L, 1);
  const std::string place = where(L);
  const std::string complete = place.empty() || says_where(text) ? text : place + ": " + text;
  lua_pushlstring(L, complete.data(), complete.size());
  return 1;
}

int describe_error_safely(lua_State* L) {
  std::string text;
  try {
    return describe_error(L);
  } catch (const std::exception& error) {
    text = error.what();
  }
  lua_pushlstring(L, text.data(), text.size());
  return 1;
}

}  // namespace

/// Stands before each block that Lua owns. 16 bytes, so that the block stays aligned as malloc aligned it.
struct Sandbox::BlockHeader {
  std::uint64_t order;
  std::uint32_t shown;
  std::uint32_t unused;
};

Sandbox::Sandbox(std::string name, std::size_t memory_limit) : name_(std::move(name)), memory_limit_(memory_limit) {
  static_assert(sizeof(BlockHeader) == 16);
  lua_ = lua_newstate(&Sandbox::allocate, this);
  if (lua_ == nullptr)
    fail(ErrorKind::input, "{}: the memory limit of {} bytes is too small for Lua itself", name_, memory_limit_);
  const auto* content = static_cast<const std::byte*>(lua_newuserdata(lua_, 1));
  userdata_offset_ = static_cast<std::size_t>(content - static_cast<const std::byte*>(newest_block_));
  lua_pop(lua_, 1);
  lua_gc(lua_, LUA_GCSETPAUSE, 150);  // Lua 5.1 does not collect when memory runs out: collect well before
  lua_sethook(lua_, &Sandbox::count_hook, LUA_MASKCOUNT, kHookInterval);
  allow(100'000'000);
  open_library(lua_);
}

Sandbox::~Sandbox() {
  if (lua_ != nullptr) lua_close(lua_);
}

Sandbox& Sandbox::of(lua_State* L) {
  void* sandbox = nullptr;
  lua_getallocf(L, &sandbox);
  return *static_cast<Sandbox*>(sandbox);
}

void* Sandbox::allocate(void* sandbox, void* block, std::size_t old_size, std::size_t new_size) {
  return static_cast<Sandbox*>(sandbox)->resize(block, old_size, new_size);
}

void* Sandbox::resize(void* block, std::size_t old_size, std::size_t new_size) {
  std::byte* const old_start = block == nullptr ? nullptr : static_cast<std::byte*>(block) - sizeof(BlockHeader);
  if (new_size == 0) {
    std::free(old_start);
    memory_used_ -= old_size;
    return nullptr;
  }
  if (new_size > old_size) {
    work_ += (new_size - old_size) / kBytesPerUnit;  // raised at the next look: an allocator cannot
    if (memory_used_ + (new_size - old_size) > memory_limit_) {
      if (lua_ != nullptr) memory_where_ = where(lua_);
      return nullptr;
    }
  }
  auto* const start = static_cast<std::byte*>(std::realloc(old_start, new_size + sizeof(BlockHeader)));
  if (start == nullptr) return nullptr;
  memory_used_ = memory_used_ - old_size + new_size;
  if (old_start == nullptr) {
    const BlockHeader header{.order = ++blocks_made_, .shown = 0, .unused = 0};
    std::memcpy(start, &header, sizeof header);
  }
  newest_block_ = start + sizeof(BlockHeader);
  return newest_block_;
}

void Sandbox::allow(std::uint64_t work) {
  work_ = 0;
  work_limit_ = work;
  spent_ = false;
}

void Sandbox::raise_spent(lua_State* L) {
  // From now on every instruction of this coroutine raises again, so that a loop around pcall ends as well; its resumer
  // is caught at its own next look.
  spent_ = true;
  lua_sethook(L, &Sandbox::count_hook, LUA_MASKCOUNT, 1);
  raise(L, "the script has run for {} instructions without coming to an end; look for a loop that never ends",
        work_limit_);
}

void Sandbox::count_hook(lua_State* L, lua_Debug*) {
  Sandbox& sandbox = of(L);
  if (lua_gethookcount(L) != kHookInterval && !sandbox.spent_) {
    lua_sethook(L, &Sandbox::count_hook, LUA_MASKCOUNT, kHookInterval);  // a former allowance was spent here
    return;
  }
  sandbox.work_ += kHookInterval;
  if (sandbox.spent_ || sandbox.work_ > sandbox.work_limit_) sandbox.raise_spent(L);
}

void Sandbox::charge(lua_State* L, std::uint64_t work) {
  work_ += work;
  if (spent_ || work_ > work_limit_) raise_spent(L);
}

std::optional<LuaFailure> Sandbox::load(lua_State* L, const std::string& chunk_name, const std::string& content) {
  if (!content.empty() && content.front() == LUA_SIGNATURE[0])
    return LuaFailure{fmt::format("{}: holds compiled Lua; give the script's text", chunk_name)};
  const std::string source = "@" + chunk_name;
  // A first line "#!…" is for a shell. Kept empty so that line numbers stay true.
  const std::size_t skipped =
      !content.empty() && content.front() == '#' ? std::min(content.find('\n'), content.size()) : 0;
  const int status = luaL_loadbuffer(L, content.data() + skipped, content.size() - skipped, source.c_str());
  if (status != 0) return take_failure(L, status);
  return std::nullopt;
}

std::optional<LuaFailure> Sandbox::call(lua_State* L, int arguments, int results) {
  const int function = lua_gettop(L) - arguments;
  VERISIM_ASSERT(arguments >= 0);
  VERISIM_ASSERT(function >= 1);
  lua_pushcfunction(L, describe_error_safely);
  lua_insert(L, function);
  const int status = lua_pcall(L, arguments, results, function);
  std::optional<LuaFailure> failure;
  if (status != 0) failure = take_failure(L, status);
  lua_remove(L, function);
  return failure;
}

Sandbox::Resumed Sandbox::resume(lua_State* thread, int arguments, LuaFailure& failure) {
  VERISIM_ASSERT(arguments <= lua_gettop(thread));
  const int status = lua_resume(thread, arguments);
  if (status == LUA_YIELD) return Resumed::yielded;
  if (status == 0) return Resumed::ended;
  failure = take_failure(thread, status);
  return Resumed::failed;
}

LuaFailure Sandbox::take_failure(lua_State* L, int status) {
  LuaFailure failure;
  if (status == LUA_ERRMEM) {
    failure.text =
        fmt::format("{}: the script needs more than {} MiB of memory; look for a table or text that grows without end",
                    memory_where_.empty() ? name_ : memory_where_, memory_limit_ / kMebibyte);
  } else if (lua_type(L, -1) == LUA_TSTRING) {
    failure.text = lua_tostring(L, -1);
  } else {
    failure.text = fmt::format("{}: the script raised an error that is no text", name_);
  }
  if (!says_where(failure.text)) failure.text = name_ + ": " + failure.text;
  failure.text += global_suggestion(L, failure.text);
  lua_pop(L, 1);
  return failure;
}

Sandbox::BlockHeader* Sandbox::header_of(lua_State* L, int index) const {
  // A table, function or thread is a block; a full userdata's content lies behind its own header in a block.
  auto* block = const_cast<std::byte*>(static_cast<const std::byte*>(lua_topointer(L, index)));
  if (lua_type(L, index) == LUA_TUSERDATA) block -= userdata_offset_;
  return reinterpret_cast<BlockHeader*>(block - sizeof(BlockHeader));
}

std::uint64_t Sandbox::creation_order(lua_State* L, int index) const {
  return header_of(L, index)->order;
}

std::uint32_t Sandbox::shown_number(lua_State* L, int index) {
  BlockHeader* header = header_of(L, index);
  if (header->shown == 0) header->shown = ++numbers_shown_;
  return header->shown;
}

std::string where(lua_State* L) {
  lua_Debug record;
  for (int level = 0; lua_getstack(L, level, &record) != 0; ++level) {
    lua_getinfo(L, "Sl", &record);
    if (record.currentline > 0) return fmt::format("{}:{}", record.short_src, record.currentline);
  }
  return {};
}

void raise_text(lua_State* L, const std::string& text) {
  const std::string place = where(L);
  const std::string complete = place.empty() ? text : place + ": " + text;
  lua_pushlstring(L, complete.data(), complete.size());
  lua_error(L);
  std::abort();  // lua_error does not return
}

}  // namespace verisim::script
