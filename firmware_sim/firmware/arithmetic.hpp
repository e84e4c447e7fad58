// firmware_sim/firmware/arithmetic.hpp
// Integer arithmetic that treats both directions alike. C++14 without standard library.
#pragma once

#include <stdint.h>

namespace verisim {
namespace firmware {

inline int32_t magnitude(int32_t value) {
  return value < 0 ? -value : value;
}

/// numerator / denominator, rounded half away from zero. @pre denominator above 0; no overflow of numerator +
/// denominator/2
inline int32_t rounded(int32_t numerator, int32_t denominator) {
  return (numerator + (numerator < 0 ? -denominator / 2 : denominator / 2)) / denominator;
}

}  // namespace firmware
}  // namespace verisim
