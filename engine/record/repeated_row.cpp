#include "engine/record/repeated_row.hpp"

#include <bit>
#include <cstdint>

#include "engine/base/error.hpp"

namespace verisim {
namespace {

constexpr unsigned kLongestCopy = 258;  // bytes

/// Bits go into bytes from the lowest on; Huffman codes are the only ones that begin with their highest bit.
class Bits {
 public:
  void number(std::uint32_t value, unsigned count) {
    for (unsigned i = 0; i < count; ++i) bit(value >> i & 1);
  }
  void code(std::uint32_t value, unsigned count) {
    for (unsigned i = count; i-- > 0;) bit(value >> i & 1);
  }
  void end_byte() { used_ = 0; }
  void byte(std::uint32_t value) {
    VERISIM_ASSERT(used_ == 0);
    bytes_.push_back(static_cast<std::byte>(value & 0xff));
  }
  [[nodiscard]] std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  void bit(std::uint32_t value) {
    if (used_ == 0) bytes_.push_back(std::byte{0});
    bytes_.back() |= static_cast<std::byte>(value << used_);
    used_ = (used_ + 1) % 8;
  }
  std::vector<std::byte> bytes_;
  unsigned used_ = 0;  ///< bits of the last byte; 0: it is full
};

// RFC 1951, 3.2.6: the codes that every reader knows.
void put_literal(Bits& bits, std::byte value) {
  const auto v = static_cast<std::uint32_t>(value);
  if (v < 144) {
    bits.code(0x30 + v, 8);
  } else {
    bits.code(0x190 + v - 144, 9);
  }
}

/// The 258 bytes that begin `distance` before the end, as if they were there already.
void put_longest_copy(Bits& bits, std::size_t distance) {
  bits.code(0xc5, 8);
  const auto d = static_cast<std::uint32_t>(distance - 1);
  if (d < 4) return bits.code(d, 5);
  const unsigned extra = static_cast<unsigned>(std::bit_width(d)) - 2;
  bits.code(2 * (extra + 1) + (d >> extra & 1), 5);
  bits.number(d & ((1U << extra) - 1), extra);
}

/// Adler-32 (RFC 1950, 8) in closed form: a = 1 + sum of the bytes; b = sum of all values that a takes.
std::uint32_t checksum(std::span<const std::byte> row, std::uint64_t times) {
  constexpr std::uint64_t kPrime = 65521;
  const std::uint64_t length = row.size();
  std::uint64_t sum = 0, weighted = 0;
  for (std::size_t i = 0; i < row.size(); ++i) {
    sum += static_cast<std::uint64_t>(row[i]);
    weighted += (length - i) * static_cast<std::uint64_t>(row[i]);
  }
  const std::uint64_t pairs = times * (times - 1) / 2 % kPrime;  // each row adds to the b of every later one
  const std::uint64_t a = (1 + times % kPrime * (sum % kPrime)) % kPrime;
  const std::uint64_t b =
      (times % kPrime * ((length + weighted) % kPrime) + length * (sum % kPrime) % kPrime * pairs) % kPrime;
  return static_cast<std::uint32_t>(b << 16 | a);
}

}  // namespace

std::vector<std::byte> deflated(std::span<const std::byte> row, std::size_t times) {
  VERISIM_ASSERT(!row.empty() && row.size() <= 32768 && times > 0);
  Bits bits;
  bits.byte(0x78);  // deflate, a window of 32768 bytes
  bits.byte(0x01);
  bits.number(1, 1);  // the last block
  bits.number(1, 2);  // of the known codes
  for (const std::byte value : row) put_literal(bits, value);
  std::size_t left = row.size() * (times - 1);
  for (; left >= kLongestCopy; left -= kLongestCopy) put_longest_copy(bits, row.size());
  for (std::size_t i = row.size() * times - left; left > 0; ++i, --left) put_literal(bits, row[i % row.size()]);
  bits.code(0, 7);  // the block's end
  bits.end_byte();
  const std::uint32_t sum = checksum(row, times);
  for (const unsigned shift : {24U, 16U, 8U, 0U}) bits.byte(sum >> shift);
  return bits.take();
}

}  // namespace verisim
