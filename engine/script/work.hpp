// The one meter of a script's work. Whatever works for a script adds to it, in units of about one Lua instruction (5 to
// 10 ns): the count hook (instructions), the allocator (bytes), Lua's tables and texts (lua_tables.cpp, lua_work.cpp:
// slots and bytes gone through), library functions (their declared charge, sandbox.hpp).
//
// One per thread. It only counts; Sandbox decides what is too much, and only while a script runs under its protection.
#pragma once

#include <cstdint>
#include <limits>

struct lua_State;

namespace verisim::script {

struct Work {
  std::uint64_t used = 0;
  /// `used` above this is too much. Without end while no script runs.
  std::uint64_t limit = std::numeric_limits<std::uint64_t>::max();
};
extern thread_local constinit Work work;

/// Raises a Lua error. Only where the allowance is known to be spent: raise_if_spent.
[[noreturn]] void raise_spent(lua_State* L);

/// Where Lua itself may raise (it may run out of memory there as well).
inline void raise_if_spent(lua_State* L) {
  if (work.used > work.limit) raise_spent(L);
}

/// Stands before each block that Lua owns. 16 bytes, so that the block stays aligned as malloc aligned it.
struct BlockHeader {
  std::uint64_t order;  ///< of making, among all blocks
  std::uint32_t shown;
  std::uint32_t destroyer;  ///< 0: none; else which one of the sandbox takes its content apart
};

/// @pre a Sandbox allocated the block
[[nodiscard]] inline std::uint64_t creation_order_of(const void* block) {
  return (static_cast<const BlockHeader*>(block) - 1)->order;
}

/// What compiling a text takes at most: its bytes, the names that are looked up through functions within functions, the
/// jumps that Lua keeps in lists and walks through (lua_source_work.cpp).
[[nodiscard]] std::uint64_t work_of_compiling(const char* text, std::uint64_t size);

}  // namespace verisim::script
