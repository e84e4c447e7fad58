#include "engine/script/sandbox.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string_view>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/base/text.hpp"

namespace verisim::script {
namespace {

constexpr int kHookInterval = 200;         // instructions between two looks at the allowance
constexpr std::size_t kBytesPerUnit = 16;  // of memory: to ask for it, fill it, collect it
constexpr std::uint64_t kBlockWork = 4;
constexpr std::size_t kBlockOverhead = 24;  // our header and malloc's
constexpr int kNestedMax = 220;             // library functions within each other; Lua allows 200 in one coroutine
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
  const std::string text = shown({lua_tostring(L, 1), lua_objlen(L, 1)});
  const std::string place = where(L);
  const std::string complete = place.empty() || says_where(text) ? text : place + ": " + text;
  lua_pushlstring(L, complete.data(), complete.size());
  return 1;
}

/// While something has to be said about a script that spent its allowance.
class Unlimited {
 public:
  Unlimited() { work.limit = std::numeric_limits<std::uint64_t>::max(); }
  ~Unlimited() { work.limit = limit_; }
  Unlimited(const Unlimited&) = delete;
  Unlimited& operator=(const Unlimited&) = delete;

 private:
  std::uint64_t limit_ = work.limit;
};

int describe_error_safely(lua_State* L) {
  const Unlimited unlimited;
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

Sandbox::Sandbox(std::string name, std::size_t memory_limit) : name_(std::move(name)), memory_limit_(memory_limit) {
  static_assert(sizeof(BlockHeader) == 16);
  lua_ = lua_newstate(&Sandbox::allocate, this);
  if (lua_ == nullptr)
    fail(ErrorKind::input, "{}: the memory limit of {} bytes is too small for Lua itself", name_, memory_limit_);
  const auto* content = static_cast<const std::byte*>(lua_newuserdata(lua_, 1));
  userdata_offset_ = static_cast<std::size_t>(content - static_cast<const std::byte*>(newest_block_));
  lua_pop(lua_, 1);
  lua_pushliteral(lua_, "error in error handling");  // is there when Lua needs it and no memory is left
  luaL_ref(lua_, LUA_REGISTRYINDEX);
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

namespace {
std::size_t bytes_taken(std::size_t size) {
  constexpr std::size_t kGrain = 16;
  return size == 0 ? 0 : (size + kBlockOverhead + kGrain - 1) / kGrain * kGrain;
}
}  // namespace

void* Sandbox::resize(void* block, std::size_t old_size, std::size_t new_size) {
  std::byte* const old_start = block == nullptr ? nullptr : static_cast<std::byte*>(block) - sizeof(BlockHeader);
  const std::size_t old_bytes = block == nullptr ? 0 : bytes_taken(old_size);
  const std::size_t new_bytes = bytes_taken(new_size);
  if (new_size == 0) {
    if (block != nullptr) destroy_content(block);
    std::free(old_start);
    memory_used_ -= old_bytes;
    return nullptr;
  }
  if (new_bytes > old_bytes) {
    work.used += kBlockWork + (new_bytes - old_bytes) / kBytesPerUnit;
    if (memory_used_ + (new_bytes - old_bytes) > memory_limit_) {
      if (lua_ != nullptr) memory_where_ = where(lua_);
      return nullptr;
    }
  }
  auto* const start = static_cast<std::byte*>(std::realloc(old_start, new_size + sizeof(BlockHeader)));
  if (start == nullptr) return nullptr;
  memory_used_ = memory_used_ - old_bytes + new_bytes;
  if (old_start == nullptr) {
    const BlockHeader header{.order = ++blocks_made_, .shown = 0, .destroyer = 0};
    std::memcpy(start, &header, sizeof header);
  }
  newest_block_ = start + sizeof(BlockHeader);
  return newest_block_;
}

std::uint32_t Sandbox::destroyer(void (*destroy)(void* content)) {
  const auto known = std::find(destroyers_.begin(), destroyers_.end(), destroy);
  const auto place = static_cast<std::uint32_t>(known - destroyers_.begin());
  if (known == destroyers_.end()) destroyers_.push_back(destroy);
  return place + 1;
}

void Sandbox::destroy_later(lua_State* L, int index, std::uint32_t destroyer) {
  VERISIM_ASSERT(lua_type(L, index) == LUA_TUSERDATA);
  VERISIM_ASSERT(destroyer >= 1 && destroyer <= destroyers_.size());
  header_of(L, index)->destroyer = destroyer;
}

void Sandbox::destroy_content(void* block) {
  const std::uint32_t destroyer = (static_cast<BlockHeader*>(block) - 1)->destroyer;
  if (destroyer != 0) destroyers_[destroyer - 1](static_cast<std::byte*>(block) + userdata_offset_);
}

Nesting::Nesting(lua_State* L) : sandbox_(Sandbox::of(L)) {
  if (sandbox_.nested_ >= kNestedMax)
    raise(L, "more than {} library functions call each other; look for a recursion that never ends", kNestedMax);
  ++sandbox_.nested_;
}

/// From the first call of Lua to its return, `work.limit` is what is left of the allowance. Lua's own protection must
/// stand within: whatever raises because of the limit is caught by it.
class Sandbox::Running {
 public:
  explicit Running(Sandbox& sandbox) : sandbox_(sandbox), begin_(work.used), outer_limit_(work.limit) {
    if (sandbox_.running_++ == 0) work.limit = begin_ + sandbox_.allowance_left_;
  }
  ~Running() {
    if (--sandbox_.running_ != 0) return;
    sandbox_.allowance_left_ -= std::min(work.used - begin_, sandbox_.allowance_left_);
    work.limit = outer_limit_;
  }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

 private:
  Sandbox& sandbox_;
  std::uint64_t begin_;
  std::uint64_t outer_limit_;
};

void Sandbox::allow(std::uint64_t units) {
  VERISIM_ASSERT(units > 0);
  VERISIM_ASSERT(running_ == 0);
  allowance_ = allowance_left_ = units;
}

std::string Sandbox::spent_text() const {
  return fmt::format(
      "the script has done {} units of work (instructions) without coming to an end; look for a loop that never ends",
      allowance_);
}

void raise_spent(lua_State* L) {
  const Unlimited unlimited;
  raise_text(L, Sandbox::of(L).spent_text());
}

void Sandbox::count_hook(lua_State* L, lua_Debug*) {
  charge(L, kHookInterval);
}

std::optional<LuaFailure> Sandbox::load(lua_State* L, const std::string& chunk_name, const std::string& content) {
  if (!content.empty() && content.front() == LUA_SIGNATURE[0])
    return LuaFailure{fmt::format("{}: holds compiled Lua; give the script's text", chunk_name)};
  longest_source_ = std::max(longest_source_, content.size());
  const std::string source = "@" + chunk_name;
  // A first line "#!…" is for a shell. Kept empty so that line numbers stay true.
  const std::size_t skipped =
      !content.empty() && content.front() == '#' ? std::min(content.find('\n'), content.size()) : 0;
  int status = 0;
  {
    const Running running(*this);
    work.used += work_of_compiling(content.data(), content.size());
    if (work.used > work.limit) return LuaFailure{fmt::format("{}: {}", chunk_name, spent_text())};
    status = luaL_loadbuffer(L, content.data() + skipped, content.size() - skipped, source.c_str());
  }
  if (status != 0) return take_failure(L, status);
  return std::nullopt;
}

std::optional<LuaFailure> Sandbox::call(lua_State* L, int arguments, int results) {
  const int function = lua_gettop(L) - arguments;
  VERISIM_ASSERT(arguments >= 0);
  VERISIM_ASSERT(function >= 1);
  lua_pushcfunction(L, describe_error_safely);
  lua_insert(L, function);
  int status = 0;
  {
    const Running running(*this);
    status = lua_pcall(L, arguments, results, function);
  }
  std::optional<LuaFailure> failure;
  if (status != 0) failure = take_failure(L, status);
  lua_remove(L, function);
  return failure;
}

Sandbox::Resumed Sandbox::resume(lua_State* thread, int arguments, LuaFailure& failure) {
  VERISIM_ASSERT(arguments <= lua_gettop(thread));
  int status = 0;
  {
    const Running running(*this);
    status = lua_resume(thread, arguments);
  }
  if (status == LUA_YIELD) return Resumed::yielded;
  if (status == 0) return Resumed::ended;
  failure = take_failure(thread, status);
  return Resumed::failed;
}

std::string Sandbox::memory_text() const {
  return fmt::format("the script needs more than {} MiB of memory; look for a table or text that grows without end",
                     memory_limit_ / kMebibyte);
}

LuaFailure Sandbox::take_failure(lua_State* L, int status) {
  LuaFailure failure;
  if (status == LUA_ERRMEM) {
    failure.text = fmt::format("{}: {}", memory_where_.empty() ? name_ : memory_where_, memory_text());
  } else if (lua_type(L, -1) == LUA_TSTRING) {
    failure.text = shown({lua_tostring(L, -1), lua_objlen(L, -1)});
  } else {
    failure.text = fmt::format("{}: the script raised an error that is no text", name_);
  }
  if (!lacked_.empty() && failure.text.find(shown(lacked_)) != std::string::npos) failure.kind = ErrorKind::io;
  if (!says_where(failure.text)) failure.text = name_ + ": " + failure.text;
  failure.text += global_suggestion(L, failure.text);
  lua_pop(L, 1);
  return failure;
}

BlockHeader* Sandbox::header_of(lua_State* L, int index) const {
  // A table, function or thread is a block; a full userdata's content lies behind its own header in a block.
  VERISIM_ASSERT(!lua_islightuserdata(L, index));
  auto* block = const_cast<std::byte*>(static_cast<const std::byte*>(lua_topointer(L, index)));
  VERISIM_ASSERT(block != nullptr);
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
