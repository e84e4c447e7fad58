// How much of a sweep a test goes through. Under the sanitizers programs are some ten times slower, and what they look
// for is in the code that runs, not in how often: there a sweep may be a part of itself. VERISIM_LONG_TESTS=1 asks for
// the long form.
#pragma once

#include <cstdlib>

namespace verisim::test {

#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

inline bool is_long() {
  return std::getenv("VERISIM_LONG_TESTS") != nullptr;
}

/// The one of these that is asked for.
template <typename T>
T by_length(T sanitized, T usual, T in_full) {
  return is_long() ? in_full : kSanitized ? sanitized : usual;
}

}  // namespace verisim::test
