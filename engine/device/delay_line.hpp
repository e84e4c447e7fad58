// Values that come out a fixed number of frames after they went in. No allocation after construction.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/base/contract.hpp"

namespace verisim {

template <typename T>
class DelayLine {
 public:
  /// @param frames_max  room; a delay is less than that
  explicit DelayLine(std::size_t frames_max) : values_(frames_max) {}

  /// Puts a value in and returns that of `frames` calls before; of the first call while there was none.
  /// @pre frames < frames_max
  const T& put(const T& value, std::size_t frames) {
    VERISIM_ASSERT(frames < values_.size());
    values_[count_ % values_.size()] = value;
    const std::size_t at = count_ < frames ? 0 : count_ - frames;
    ++count_;
    return values_[at % values_.size()];
  }

 private:
  std::vector<T> values_;
  std::size_t count_ = 0;
};

}  // namespace verisim
