// A hash map from a pair of numbers to a number: open addressing, linear probing, capacity fixed when it is made.
//
// Nothing allocates after construction, nothing is ever erased, and nothing depends on the order of the slots: only
// look-ups by key exist. Cost of a look-up: one multiplication and, at a load of a half at most, one or two probes.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "engine/base/error.hpp"

namespace verisim {

class PairMap {
 public:
  static constexpr std::uint32_t kAbsent = 0xFFFFFFFF;

  explicit PairMap(std::size_t capacity = 0)
      : capacity_(capacity), slots_(std::bit_ceil(2 * capacity + 2)), shift_(64 - std::countr_zero(slots_.size())) {}

  /// The value of (a, b), or kAbsent.
  [[nodiscard]] std::uint32_t find(std::uint32_t a, std::uint32_t b) const { return slots_[slot_of(a, b)].value; }

  /// @pre (a, b) is absent, size() < capacity(), value is not kAbsent
  void insert(std::uint32_t a, std::uint32_t b, std::uint32_t value) {
    Slot& slot = slots_[slot_of(a, b)];
    VERISIM_ASSERT(slot.value == kAbsent);
    VERISIM_ASSERT(size_ < capacity_);
    VERISIM_ASSERT(value != kAbsent);
    slot = {key_of(a, b), value};
    ++size_;
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t capacity() const { return capacity_; }

 private:
  struct Slot {
    std::uint64_t key = 0;
    std::uint32_t value = kAbsent;
  };
  static std::uint64_t key_of(std::uint32_t a, std::uint32_t b) { return (std::uint64_t{a} << 32U) | b; }
  /// Where the key is, or the free slot where it would be. Half of the slots are free, so the search ends.
  [[nodiscard]] std::size_t slot_of(std::uint32_t a, std::uint32_t b) const {
    const std::uint64_t key = key_of(a, b);
    std::size_t i = (key * 0x9E3779B97F4A7C15ULL) >> static_cast<unsigned>(shift_);  // 2^64 over the golden ratio
    while (slots_[i].value != kAbsent && slots_[i].key != key) i = (i + 1) & (slots_.size() - 1);
    return i;
  }

  std::size_t capacity_;
  std::size_t size_ = 0;
  std::vector<Slot> slots_;
  int shift_;
};

}  // namespace verisim
