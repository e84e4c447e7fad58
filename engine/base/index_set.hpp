// A set of small numbers (bodies, links) that is filled anew in every frame and listed in ascending order, whatever
// order they came in.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/base/error.hpp"

namespace verisim {

class IndexSet {
 public:
  /// Room for the numbers 0 to size - 1.
  explicit IndexSet(std::size_t size = 0) : words_((size + kBits - 1) / kBits, 0) {}

  /// @pre i is below the size
  void add(std::size_t i) {
    VERISIM_ASSERT(i / kBits < words_.size());
    words_[i / kBits] |= std::uint64_t{1} << i % kBits;
  }
  /// @pre i is below the size
  [[nodiscard]] bool has(std::size_t i) const {
    VERISIM_ASSERT(i / kBits < words_.size());
    return (words_[i / kBits] >> i % kBits & 1) != 0;
  }
  /// Appends all of them, ascending. Costs their number and a 64th of the size.
  void append_to(std::vector<std::size_t>& list) const {
    for (std::size_t w = 0; w < words_.size(); ++w) {
      for (std::uint64_t left = words_[w]; left != 0; left &= left - 1)
        list.push_back(w * kBits + static_cast<std::size_t>(std::countr_zero(left)));
    }
  }
  void clear() { std::fill(words_.begin(), words_.end(), 0); }
  /// Appends all of them and empties the set.
  void move_to(std::vector<std::size_t>& list) {
    append_to(list);
    clear();
  }

 private:
  static constexpr std::size_t kBits = 64;
  std::vector<std::uint64_t> words_;
};

}  // namespace verisim
