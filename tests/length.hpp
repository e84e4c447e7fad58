// How much of a sweep a test goes through. Under the sanitizers programs are some ten times slower, and what they look
// for is in the code that runs, not in how often: there a sweep may be a part of itself. VERISIM_LONG_TESTS=1 asks for
// the long form.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <initializer_list>
#include <span>
#include <vector>

namespace verisim::test {

#if defined(VERISIM_SANITIZED)
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

/// All of them; under the sanitizers every third, or one in `every`, the first among them.
template <typename T>
std::vector<T> some_of(std::span<const T> all, std::size_t every = 3) {
  std::vector<T> chosen;
  for (std::size_t i = 0; i < all.size(); i += kSanitized ? every : 1) chosen.push_back(all[i]);
  return chosen;
}
template <typename T>
std::vector<T> some_of(const std::vector<T>& all, std::size_t every = 3) {
  return some_of(std::span<const T>(all), every);
}
template <typename T>
std::vector<T> some_of(std::initializer_list<T> all, std::size_t every = 3) {
  return some_of(std::span<const T>(all.begin(), all.size()), every);
}
template <typename T, std::size_t N>
std::vector<T> some_of(const T (&all)[N], std::size_t every = 3) {
  return some_of(std::span<const T>(all), every);
}

}  // namespace verisim::test
