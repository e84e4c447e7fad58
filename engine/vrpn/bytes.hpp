// Numbers in network byte order: big-endian integers of 32 bits and IEEE 754 doubles.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace verisim::vrpn {

using Bytes = std::vector<std::uint8_t>;
using View = std::span<const std::uint8_t>;

void put_uint32(Bytes& out, std::uint32_t value);
void put_int32(Bytes& out, std::int32_t value);
void put_float64(Bytes& out, double value);
/// The text and one NUL.
void put_text(Bytes& out, std::string_view text);

/// Reads a payload from its beginning. Reading past the end gives 0 and sets ok() to false for good.
class Reader {
 public:
  explicit Reader(View bytes) : rest_(bytes) {}
  [[nodiscard]] std::uint32_t uint32();
  [[nodiscard]] std::int32_t int32();
  [[nodiscard]] double float64();
  [[nodiscard]] View rest() const { return rest_; }
  [[nodiscard]] bool ok() const { return ok_; }

 private:
  [[nodiscard]] std::uint64_t big_endian(std::size_t bytes);

  View rest_;
  bool ok_ = true;
};

/// The characters before the first NUL (all, if there is none).
[[nodiscard]] std::string_view text_before_nul(View bytes);

}  // namespace verisim::vrpn
