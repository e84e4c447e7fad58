// The numbers of a packed row that must be finite: every f64 of its columns but where NaN says that nothing is known.
// One pass, half a nanosecond a number.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include "engine/base/columns.hpp"

namespace verisim {

class FiniteNumbers {
 public:
  /// Of rows that hold these columns one behind the other, without padding.
  explicit FiniteNumbers(const std::vector<Column>& columns) {
    std::size_t offset = 0;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const std::size_t bytes = columns[i].bytes();
      if (columns[i].dtype == Dtype::f64 && !columns[i].may_be_nan) {
        numbers_.push_back({offset, columns[i].width, i});
        const bool adjoins = !stretches_.empty() && stretches_.back().first + 8 * stretches_.back().second == offset;
        if (adjoins)
          stretches_.back().second += columns[i].width;
        else
          stretches_.emplace_back(offset, columns[i].width);
      }
      offset += bytes;
    }
  }

  [[nodiscard]] bool all_in(const std::byte* row) const {
    std::uint64_t sign = 0;  // an exponent of ones carries into it
    for (const auto& [offset, count] : stretches_)
      for (std::size_t i = 0; i < count; ++i) sign |= (bits(row + offset + 8 * i) & kExponent) + kExponentUnit;
    return (sign >> 63) == 0;
  }

  /// Of those in `bytes` from `offset` on. @pre columns begin and end there
  [[nodiscard]] bool all_in(const std::byte* row, std::size_t offset, std::size_t bytes) const {
    std::uint64_t sign = 0;
    const auto ends_before = [](const auto& stretch, std::size_t at) {
      return stretch.first + 8 * stretch.second <= at;
    };
    auto stretch = std::lower_bound(stretches_.begin(), stretches_.end(), offset, ends_before);
    for (; stretch != stretches_.end() && stretch->first < offset + bytes; ++stretch) {
      const std::size_t from = std::max(offset, stretch->first);
      const std::size_t to = std::min(offset + bytes, stretch->first + 8 * stretch->second);
      for (std::size_t at = from; at < to; at += 8) sign |= (bits(row + at) & kExponent) + kExponentUnit;
    }
    return (sign >> 63) == 0;
  }

  struct Place {
    std::size_t column, component;
    double value;
  };
  /// The first that is not; nothing: all are.
  [[nodiscard]] std::optional<Place> first_not_in(const std::byte* row) const {
    for (const Numbers& n : numbers_)
      for (std::size_t i = 0; i < n.count; ++i) {
        const std::byte* at = row + n.offset + 8 * i;
        if ((bits(at) & kExponent) != kExponent) continue;
        double value = 0;
        std::memcpy(&value, at, sizeof value);
        return Place{n.column, i, value};
      }
    return {};
  }

 private:
  static constexpr std::uint64_t kExponent = 0x7ff0'0000'0000'0000, kExponentUnit = 0x0010'0000'0000'0000;
  static std::uint64_t bits(const std::byte* at) {
    std::uint64_t value = 0;
    std::memcpy(&value, at, sizeof value);
    return value;
  }
  struct Numbers {
    std::size_t offset, count, column;
  };
  std::vector<Numbers> numbers_;
  std::vector<std::pair<std::size_t, std::size_t>> stretches_;  ///< offset and count of numbers that lie together
};

}  // namespace verisim
