// A sandboxed Lua 5.1 interpreter: bounded in memory and in work, without files, clocks, addresses or anything else
// that differs between two runs.
//
// Lua is linked as C++ (its errors are exceptions): a function called from Lua may hold objects with destructors when
// it raises. Only engine/script includes Lua's headers.
#pragma once

#include <fmt/format.h>
#include <new>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <lua.hpp>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/script/work.hpp"

namespace verisim::script {

/// The failure of a chunk or a call. `text` is one line that begins with FILE:LINE where that is
/// known. `kind` is io if it tells what the system lacked when the script asked for something: no fault of the script.
struct LuaFailure {
  std::string text;
  ErrorKind kind = ErrorKind::input;
};

/// Of one charge: whatever is computed wrongly, the meter does not go round.
inline constexpr std::uint64_t kMostAtOnce = std::uint64_t{1} << 48;

class Sandbox {
 public:
  /// `name` is the script's file name; it begins the messages that have no line.
  Sandbox(std::string name, std::size_t memory_limit);
  virtual ~Sandbox();
  Sandbox(const Sandbox&) = delete;
  Sandbox& operator=(const Sandbox&) = delete;

  /// The sandbox that `L` (or the coroutine L) belongs to.
  static Sandbox& of(lua_State* L);
  [[nodiscard]] lua_State* lua() const { return lua_; }
  [[nodiscard]] const std::string& name() const { return name_; }

  /// Sets the allowance to `units` of work (work.hpp). Clears an exceeded limit. @pre units > 0; no script runs
  void allow(std::uint64_t units);
  /// Charges work. Raises a Lua error once the allowance is spent; nothing that a script does can catch that one.
  static void charge(lua_State* L, std::uint64_t units) {
    work.used += std::min(units, kMostAtOnce);
    raise_if_spent(L);
  }
  /// Counts bytes that the engine keeps for the script as the script's memory, until let_go. Beyond the limit it is
  /// Lua's next allocation that fails. A library function that keeps something outside Lua calls it.
  void keep(std::size_t bytes) {
    work.used += bytes / 16;
    memory_used_ += bytes;
  }
  void let_go(std::size_t bytes) { memory_used_ -= bytes; }
  /// Bytes of the longest text that was compiled: an upper bound for the length of a function.
  [[nodiscard]] std::size_t longest_source() const { return longest_source_; }
  /// How many coroutines have resumed each other.
  int& resumed() { return resumed_; }

  /// Compiles text (never bytecode) and leaves the function on L's stack; on failure leaves nothing.
  std::optional<LuaFailure> load(lua_State* L, const std::string& chunk_name, const std::string& content);
  /// Calls the function below its `arguments` on L's stack. On failure leaves nothing on the stack.
  /// @pre they are there: a function and its arguments
  std::optional<LuaFailure> call(lua_State* L, int arguments, int results);
  /// Resumes a coroutine with the arguments on its stack. @pre they are there
  enum class Resumed { ended, yielded, failed };
  Resumed resume(lua_State* thread, int arguments, LuaFailure& failure);

  /// Creation number of the object at `index` among all objects. It replaces the address wherever an order or a name is
  /// needed. @pre there is an object, here and below: a table, function, thread or full userdata
  [[nodiscard]] std::uint64_t creation_order(lua_State* L, int index) const;
  /// Of an Error that becomes a Lua error: its kind, in case the script ends by it.
  void remember(const Error& error) {
    if (error.kind() == ErrorKind::io) lacked_ = error.what();
  }
  /// Is `function` one whose work was declared when it was registered (set_function)?
  [[nodiscard]] bool is_declared(lua_CFunction function) const { return declared_.contains(function); }
  void declare(lua_CFunction function) { declared_.insert(function); }
  /// A small number for the object, given at the first request: what tostring() shows for its address.
  [[nodiscard]] std::uint32_t shown_number(lua_State* L, int index);

  /// A number for a function that takes a full userdata's content apart. @pre it calls nothing of Lua
  [[nodiscard]] std::uint32_t destroyer(void (*destroy)(void* content));
  /// Lua frees the full userdata at `index` only after that function. Not by __gc, which Lua calls like any function
  /// and which the end of the allowance or of the memory would keep from being called: what the content holds would be
  /// lost.
  void destroy_later(lua_State* L, int index, std::uint32_t destroyer);

  // Functions that the standard library needs.
  virtual void print(const std::string& line) = 0;
  [[nodiscard]] virtual double clock() const = 0;  ///< simulated time, s
  [[nodiscard]] virtual double random() = 0;       ///< next of the run's stream, in [0, 1)
  virtual void seed_random(double seed) = 0;       ///< begins another stream of the run's seed
  virtual void stop() = 0;                         ///< os.exit

 private:
  friend void script::raise_spent(lua_State* L);
  class Running;
  static void* allocate(void* sandbox, void* block, std::size_t old_size, std::size_t new_size);
  static void count_hook(lua_State* L, lua_Debug* record);
  void* resize(void* block, std::size_t old_size, std::size_t new_size);
  [[nodiscard]] std::string spent_text() const;
  [[nodiscard]] std::string memory_text() const;
  BlockHeader* header_of(lua_State* L, int index) const;
  void destroy_content(void* block);
  LuaFailure take_failure(lua_State* L, int status);

  std::string name_;
  lua_State* lua_ = nullptr;
  std::size_t memory_limit_;
  std::size_t memory_used_ = 0;
  std::uint64_t blocks_made_ = 0;
  std::uint32_t numbers_shown_ = 0;
  void* newest_block_ = nullptr;
  std::size_t userdata_offset_ = 0;  ///< from a userdata's block to its content; measured, not assumed
  std::vector<void (*)(void*)> destroyers_;
  std::string memory_where_;          ///< FILE:LINE at which memory ran out
  std::string lacked_;                ///< text of the last Error(io) that became a Lua error
  std::uint64_t allowance_ = 0;       ///< units
  std::uint64_t allowance_left_ = 0;  ///< while no script runs
  int running_ = 0;                   ///< calls of Lua within each other that began here
  int nested_ = 0;
  int resumed_ = 0;
  std::size_t longest_source_ = 0;
  std::set<lua_CFunction, std::less<>> declared_;
  friend class Nesting;
};

/// Counts library functions that run within each other, in all coroutines together: Lua counts each coroutine by
/// itself, and the processor's stack would overflow. Raises a Lua error when they are too many.
class Nesting {
 public:
  explicit Nesting(lua_State* L);
  ~Nesting() { --sandbox_.nested_; }
  Nesting(const Nesting&) = delete;
  Nesting& operator=(const Nesting&) = delete;

 private:
  Sandbox& sandbox_;
};

/// FILE:LINE of the innermost Lua function that is running, or an empty string.
[[nodiscard]] std::string where(lua_State* L);

/// Raises a Lua error "FILE:LINE: text".
[[noreturn]] void raise_text(lua_State* L, const std::string& text);
template <typename... Args>
[[noreturn]] void raise(lua_State* L, fmt::format_string<Args...> format, Args&&... args) {
  raise_text(L, fmt::format(format, std::forward<Args>(args)...));
}

/// What a library function's call is charged before it begins. No function is registered without one.
enum class Charge : std::uint32_t {
  call = 20,    ///< constant work, a few values
  own = 21,     ///< work that grows with its arguments: the function charges it itself, before or while it works
  scene = 500,  ///< makes or changes something outside Lua, of constant size
};

/// Calls F and turns what the engine throws into a Lua error at the line of the script that called it.
template <int (*F)(lua_State*), Charge C>
int guarded(lua_State* L) {
  Sandbox::charge(L, static_cast<std::uint32_t>(C));
  const Nesting nesting(L);
  std::string text;
  try {
    return F(L);
  } catch (const std::bad_alloc&) {
    text = "out of memory";  // the process's: Lua's own is bounded and says so itself
  } catch (const Error& error) {
    Sandbox::of(L).remember(error);
    text = error.what();
  } catch (const std::exception& error) {  // never Lua's own exception: that is a pointer
    text = error.what();
  }
  raise_text(L, text);
}

/// Pushes F, with as many upvalues as are on top of the stack.
template <int (*F)(lua_State*), Charge C>
void push_function(lua_State* L, int upvalues = 0) {
  Sandbox::of(L).declare(guarded<F, C>);
  lua_pushcclosure(L, guarded<F, C>, upvalues);
}
/// Sets field `name` of the table on top of the stack to the C++ function F.
template <int (*F)(lua_State*), Charge C>
void set_function(lua_State* L, const char* name) {
  push_function<F, C>(L);
  lua_setfield(L, -2, name);
}
/// Sets a global to the C++ function F.
template <int (*F)(lua_State*), Charge C>
void set_global(lua_State* L, const char* name) {
  push_function<F, C>(L);
  lua_setglobal(L, name);
}

/// The standard library, as far as it is harmless and the same in every run (lua_library.cpp).
void open_library(lua_State* L);
/// Of the libraries that are open: keeps what is declared, removes the rest (lua_own.cpp).
void keep_declared_functions(lua_State* L);
/// pcall, xpcall, coroutines, ipairs (lua_control.cpp).
void open_control(lua_State* L);
/// Expect the table `string`, `table` on top of the stack (lua_strings.cpp, lua_lists.cpp).
void open_strings(lua_State* L);
void open_lists(lua_State* L);

}  // namespace verisim::script
