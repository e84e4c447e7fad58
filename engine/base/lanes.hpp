// Four floats computed at once, with the compiler's own vectors: operators act on each lane by itself
// and round as one number does, so the bits are those of a plain loop. For short loops outside the contact query.
#pragma once

#include <cstring>

namespace verisim {

using Float4 [[gnu::vector_size(16)]] = float;

/// Four neighbours of a column. p need not be aligned.
[[nodiscard]] inline Float4 load4(const float* p) {
  Float4 lanes;
  std::memcpy(&lanes, p, sizeof lanes);
  return lanes;
}
inline void store4(Float4 lanes, float* p) {
  std::memcpy(p, &lanes, sizeof lanes);
}

}  // namespace verisim
