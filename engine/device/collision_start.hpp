// When a collision starts, for someone who feels it (dissertation section 4.3.2 and 4.5). Penalty contact goes in and
// out of collision rapidly, and the number of contacts of what slides goes up and down; neither is a start. So the
// count of a frame is compared with the largest count of a short time before it: the short-term maximum.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "engine/base/contract.hpp"

namespace verisim {

/// The largest count of the last `window` seconds, to 1/32 of it. Each value is kept for at least the window.
class ShortTermMaximum {
 public:
  /// @pre window is finite and above 0
  explicit ShortTermMaximum(double window) : window_(window) { VERISIM_ASSERT(is_positive(window)); }
  /// @pre t is not before that of the last call
  void add(double t, std::uint32_t count) {
    const auto part = static_cast<std::int64_t>(std::floor(t / window_ * kParts));
    VERISIM_ASSERT(part >= last_);
    for (std::int64_t i = std::max(last_ + 1, part - kKept + 1); i <= part; ++i) at(i) = 0;
    last_ = part;
    at(part) = std::max(at(part), count);
  }
  [[nodiscard]] std::uint32_t value() const { return *std::max_element(counts_.begin(), counts_.end()); }

 private:
  static constexpr std::int64_t kParts = 32, kKept = kParts + 1;
  [[nodiscard]] std::uint32_t& at(std::int64_t part) { return counts_[static_cast<std::size_t>(part % kKept)]; }
  double window_;
  std::int64_t last_ = -1;
  std::array<std::uint32_t, static_cast<std::size_t>(kKept)> counts_{};
};

class CollisionStart {
 public:
  static constexpr double kWindow = 0.1;       ///< s: longer than penalty contact needs to come back
  static constexpr std::uint32_t kGrowth = 2;  ///< heuristic: what slides over a face's edge adds less than that

  /// True if a collision starts in this frame: the count is more than kGrowth times the short-term maximum before it,
  /// and, while that is above 0, some time has passed since the last start. 30 ns.
  /// @param count  contacts of the frame
  /// @pre t, in seconds, is not before that of the last call
  bool update(double t, std::uint32_t count) {
    const std::uint32_t before = maximum_.value();
    const bool starts = count > kGrowth * before && (before == 0 || t - last_start_ > kWindow);
    maximum_.add(t, count);
    if (starts) last_start_ = t;
    return starts;
  }

 private:
  ShortTermMaximum maximum_{kWindow};
  double last_start_ = -kWindow;
};

}  // namespace verisim
