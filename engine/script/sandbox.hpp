// A sandboxed Lua 5.1 interpreter: bounded in memory and in work, without files, clocks, addresses or anything else
// that differs between two runs.
//
// Lua is linked as C++ (its errors are exceptions): a function called from Lua may hold objects with destructors when
// it raises. Only engine/script includes Lua's headers.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <lua.hpp>
#include <optional>
#include <string>
#include <utility>

#include "engine/base/error.hpp"

namespace verisim::script {

/// The failure of a chunk or a call. `text` is one line that begins with FILE:LINE where that is
/// known.
struct LuaFailure {
  std::string text;
};

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

  /// Sets the allowance to `work` units: instructions, and charges of library functions. Clears an exceeded limit.
  void allow(std::uint64_t work);
  /// Charges work that is not counted as instructions. Raises a Lua error once the allowance is spent.
  void charge(lua_State* L, std::uint64_t work);

  /// Compiles text (never bytecode) and leaves the function on L's stack; on failure leaves nothing.
  std::optional<LuaFailure> load(lua_State* L, const std::string& chunk_name, const std::string& content);
  /// Calls the function below its `arguments` on L's stack. On failure leaves nothing on the stack.
  /// @pre they are there: a function and its arguments
  std::optional<LuaFailure> call(lua_State* L, int arguments, int results);
  /// Resumes a coroutine with the arguments on its stack. @pre they are there
  enum class Resumed { ended, yielded, failed };
  Resumed resume(lua_State* thread, int arguments, LuaFailure& failure);

  /// Creation number of the object at `index` (table, function, thread, full userdata) among all objects. It replaces
  /// the address wherever an order or a name is needed.
  [[nodiscard]] std::uint64_t creation_order(lua_State* L, int index) const;
  /// A small number for the object, given at the first request: what tostring() shows for its address.
  [[nodiscard]] std::uint32_t shown_number(lua_State* L, int index);

  // Functions that the standard library needs.
  virtual void print(const std::string& line) = 0;
  [[nodiscard]] virtual double clock() const = 0;  ///< simulated time, s
  [[nodiscard]] virtual double random() = 0;       ///< next of the run's stream, in [0, 1)
  virtual void seed_random(double seed) = 0;       ///< begins another stream of the run's seed
  virtual void stop() = 0;                         ///< os.exit

 private:
  struct BlockHeader;
  static void* allocate(void* sandbox, void* block, std::size_t old_size, std::size_t new_size);
  static void count_hook(lua_State* L, lua_Debug* record);
  void* resize(void* block, std::size_t old_size, std::size_t new_size);
  [[noreturn]] void raise_spent(lua_State* L);
  BlockHeader* header_of(lua_State* L, int index) const;
  LuaFailure take_failure(lua_State* L, int status);

  std::string name_;
  lua_State* lua_ = nullptr;
  std::size_t memory_limit_;
  std::size_t memory_used_ = 0;
  std::uint64_t blocks_made_ = 0;
  std::uint32_t numbers_shown_ = 0;
  void* newest_block_ = nullptr;
  std::size_t userdata_offset_ = 0;  ///< from a userdata's block to its content; measured, not assumed
  std::string memory_where_;         ///< FILE:LINE at which memory ran out
  std::uint64_t work_ = 0;
  std::uint64_t work_limit_ = 0;
  bool spent_ = false;
};

/// FILE:LINE of the innermost Lua function that is running, or an empty string.
[[nodiscard]] std::string where(lua_State* L);

/// Raises a Lua error "FILE:LINE: text".
[[noreturn]] void raise_text(lua_State* L, const std::string& text);
template <typename... Args>
[[noreturn]] void raise(lua_State* L, fmt::format_string<Args...> format, Args&&... args) {
  raise_text(L, fmt::format(format, std::forward<Args>(args)...));
}

/// Calls F and turns what the engine throws into a Lua error at the line of the script that called it.
template <int (*F)(lua_State*)>
int guarded(lua_State* L) {
  std::string text;
  try {
    return F(L);
  } catch (const std::exception& error) {  // never Lua's own exception: that is a pointer
    text = error.what();
  }
  raise_text(L, text);
}

/// Sets field `name` of the table on top of the stack to the C++ function F.
template <int (*F)(lua_State*)>
void set_function(lua_State* L, const char* name) {
  lua_pushcfunction(L, guarded<F>);
  lua_setfield(L, -2, name);
}
/// Sets a global to the C++ function F.
template <int (*F)(lua_State*)>
void set_global(lua_State* L, const char* name) {
  lua_pushcfunction(L, guarded<F>);
  lua_setglobal(L, name);
}

/// The standard library, as far as it is harmless and the same in every run (lua_library.cpp).
void open_library(lua_State* L);
/// string.* with bounded work (lua_strings.cpp); expects the string table on top of the stack.
void open_strings(lua_State* L);

}  // namespace verisim::script
