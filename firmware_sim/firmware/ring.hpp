// firmware_sim/firmware/ring.hpp
// Bytes between an interrupt and the main loop: one side puts, the other takes, and neither has to keep the other out,
// because each writes one index of one byte. C++14 without standard library.
#pragma once

#include <stdint.h>

namespace verisim {
namespace firmware {

/// @pre kSize is a power of two, at most 128. Holds kSize - 1 bytes.
template <uint8_t kSize>
class Ring {
  static_assert(kSize <= 128 && (kSize & (kSize - 1)) == 0, "a power of two");

 public:
  /// False if it is full: the byte is lost.
  bool put(uint8_t byte) {
    const auto next = static_cast<uint8_t>((end_ + 1) & (kSize - 1));
    if (next == begin_) return false;
    bytes_[end_] = byte;
    end_ = next;
    return true;
  }

  bool take(uint8_t& byte) { return take_before(end_, byte); }

  /// As take, but nothing that was put after mark() gave `end`.
  bool take_before(uint8_t end, uint8_t& byte) {
    if (begin_ == end) return false;
    byte = bytes_[begin_];
    begin_ = static_cast<uint8_t>((begin_ + 1) & (kSize - 1));
    return true;
  }

  uint8_t mark() const { return end_; }
  bool is_empty() const { return begin_ == end_; }
  uint8_t space() const { return static_cast<uint8_t>((begin_ - end_ - 1) & (kSize - 1)); }

 private:
  volatile uint8_t bytes_[kSize];  // volatile: a byte is written before the index that shows it
  volatile uint8_t begin_ = 0;
  volatile uint8_t end_ = 0;
};

}  // namespace firmware
}  // namespace verisim
