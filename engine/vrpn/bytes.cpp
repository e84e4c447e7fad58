#include "engine/vrpn/bytes.hpp"

#include <algorithm>
#include <bit>

namespace verisim::vrpn {

void put_uint32(Bytes& out, std::uint32_t value) {
  for (const unsigned shift : {24U, 16U, 8U, 0U}) out.push_back(static_cast<std::uint8_t>(value >> shift));
}

void put_int32(Bytes& out, std::int32_t value) {
  put_uint32(out, std::bit_cast<std::uint32_t>(value));
}

void put_float64(Bytes& out, double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  put_uint32(out, static_cast<std::uint32_t>(bits >> 32U));
  put_uint32(out, static_cast<std::uint32_t>(bits));
}

void put_text(Bytes& out, std::string_view text) {
  out.insert(out.end(), text.begin(), text.end());
  out.push_back(0);
}

std::uint64_t Reader::big_endian(std::size_t bytes) {
  if (rest_.size() < bytes) {
    ok_ = false;
    rest_ = {};
    return 0;
  }
  std::uint64_t value = 0;
  for (const std::uint8_t byte : rest_.first(bytes)) value = value << 8U | byte;
  rest_ = rest_.subspan(bytes);
  return value;
}

std::uint32_t Reader::uint32() {
  return static_cast<std::uint32_t>(big_endian(4));
}

std::int32_t Reader::int32() {
  return std::bit_cast<std::int32_t>(uint32());
}

double Reader::float64() {
  return std::bit_cast<double>(big_endian(8));
}

std::string_view text_before_nul(View bytes) {
  const auto end = std::find(bytes.begin(), bytes.end(), std::uint8_t{0});
  return {reinterpret_cast<const char*>(bytes.data()), static_cast<std::size_t>(end - bytes.begin())};
}

}  // namespace verisim::vrpn
