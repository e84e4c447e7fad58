#include "engine/vrpn/message.hpp"

#include <algorithm>

#include "engine/base/error.hpp"

namespace verisim::vrpn {
namespace {

constexpr std::string_view kMagic = "vrpn: ver. 07.38  0";
constexpr std::size_t kMagicCompared = 14;  // "vrpn: ver. 07.": any minor version will do
constexpr std::size_t kLogMode = 18;
constexpr std::size_t kAlignment = 8;

std::size_t padded(std::size_t bytes) {
  return (bytes + kAlignment - 1) / kAlignment * kAlignment;
}

}  // namespace

void put_cookie(Bytes& out) {
  out.insert(out.end(), kMagic.begin(), kMagic.end());
  out.resize(out.size() + kCookieBytes - kMagic.size());
}

bool cookie_is_good(View cookie) {
  VERISIM_ASSERT(cookie.size() == kCookieBytes);
  const auto same = [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; };
  return std::equal(kMagic.begin(), kMagic.begin() + kMagicCompared, cookie.begin(), same) && cookie[kLogMode] >= '0' &&
         cookie[kLogMode] <= '3';
}

void put_message(Bytes& out, const Message& message) {
  VERISIM_ASSERT(padded(message.payload.size()) <= kPaddedPayloadMax);
  VERISIM_ASSERT(message.time.microseconds < 1'000'000);
  const std::size_t begin = out.size();
  put_uint32(out, static_cast<std::uint32_t>(kHeaderBytes + message.payload.size()));
  put_uint32(out, message.time.seconds);
  put_uint32(out, message.time.microseconds);
  put_int32(out, message.sender);
  put_int32(out, message.type);
  put_uint32(out, message.sequence);
  out.insert(out.end(), message.payload.begin(), message.payload.end());
  out.resize(begin + padded(out.size() - begin));
}

ParsedMessage first_message(View stream) {
  ParsedMessage parsed;
  Reader header(stream);
  const std::size_t length = header.uint32();
  if (!header.ok()) return parsed;
  if (length < kHeaderBytes || padded(length - kHeaderBytes) > kPaddedPayloadMax) {
    parsed.state = ParsedMessage::State::malformed;
    return parsed;
  }
  parsed.bytes = padded(length);
  if (stream.size() < parsed.bytes) return parsed;
  Message& m = parsed.message;
  m.time.seconds = header.uint32();
  m.time.microseconds = header.uint32();
  m.sender = header.int32();
  m.type = header.int32();
  m.sequence = header.uint32();
  m.payload = stream.subspan(kHeaderBytes, length - kHeaderBytes);
  parsed.state = ParsedMessage::State::whole;
  return parsed;
}

}  // namespace verisim::vrpn
