// Counts allocations, for tests of code that promises to make none. In a file of its own, so that the compiler does not
// mix these operators up with the library's where it inlines.
#pragma once

#include <cstddef>

namespace verisim {

/// How often operator new was called by this thread.
[[nodiscard]] std::size_t allocations();

}  // namespace verisim
