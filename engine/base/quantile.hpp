// The one quantile of the project: by nearest rank (Hyndman and Fan 1996, definition 1), always one of the values
// given.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "engine/base/error.hpp"

namespace verisim {

/// The smallest of n values that at least p n of them do not exceed: p = 0.5 the (lower) median, 0 the least, 1 the
/// greatest. O(n); the values are reordered.
/// @pre values is not empty and without NaN; 0 <= p <= 1
template <typename T>
[[nodiscard]] T quantile(std::vector<T>& values, double p) {
  VERISIM_ASSERT(!values.empty());
  VERISIM_ASSERT(p >= 0);
  VERISIM_ASSERT(p <= 1);
  if constexpr (std::is_floating_point_v<T>)
    VERISIM_ASSERT(std::none_of(values.begin(), values.end(), [](T value) { return std::isnan(value); }));
  const auto rank = static_cast<std::ptrdiff_t>(std::ceil(p * static_cast<double>(values.size())));  // from 1
  const auto place = values.begin() + std::max<std::ptrdiff_t>(rank, 1) - 1;
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

}  // namespace verisim
