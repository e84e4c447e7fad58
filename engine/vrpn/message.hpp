// Cookie and message headers of VRPN's network protocol, version 07 (reference/vrpn_wire, "Cookie", "Message",
// "Limits"). Pure functions of bytes: no sockets, no clock, no state. Safe for any input.
#pragma once

#include <cstddef>

#include "engine/vrpn/bytes.hpp"

namespace verisim::vrpn {

inline constexpr std::uint16_t kDefaultPort = 3883;
inline constexpr std::size_t kCookieBytes = 24;
inline constexpr std::size_t kHeaderBytes = 24;
inline constexpr std::size_t kPaddedPayloadMax = 64008;  ///< stock VRPN drops a connection that sends more

/// Types of system messages.
inline constexpr std::int32_t kSenderDescription = -1;
inline constexpr std::int32_t kTypeDescription = -2;
inline constexpr std::int32_t kUdpDescription = -3;
inline constexpr std::int32_t kDisconnect = -5;
inline constexpr std::int32_t kSystemTypeMin = -1999;  ///< below, stock VRPN drops the connection

/// Since 1970-01-01 UTC, by the sender's clock.
struct Timestamp {
  std::uint32_t seconds = 0;
  std::uint32_t microseconds = 0;  ///< 0 to 999999
};

/// From `begin` to `end`.
[[nodiscard]] inline std::int64_t microseconds_between(const Timestamp& begin, const Timestamp& end) {
  const auto total = [](const Timestamp& t) { return std::int64_t{t.seconds} * 1'000'000 + t.microseconds; };
  return total(end) - total(begin);
}

struct Message {
  Timestamp time;
  std::int32_t sender = 0;
  std::int32_t type = 0;
  std::uint32_t sequence = 0;  ///< not used by any reader
  View payload;                ///< of a decoded message: refers to the caller's bytes
};

/// The 24 bytes that both sides send first: version 07.38, nothing to be logged.
void put_cookie(Bytes& out);
/// Whether a peer with this cookie speaks version 07 and asks for a log mode that exists. @pre kCookieBytes long
[[nodiscard]] bool cookie_is_good(View cookie);

/// Header, payload, padding with zeros to a multiple of 8.
/// @pre the padded payload has at most kPaddedPayloadMax bytes; a second has fewer than 1000000 microseconds
void put_message(Bytes& out, const Message& message);

/// The first message of a stream or datagram.
struct ParsedMessage {
  enum class State {
    whole,       ///< `message` is valid, `bytes` long with its padding
    incomplete,  ///< valid so far, but more bytes are needed
    malformed    ///< no message can begin like this: shorter than its header, or longer than the limit
  };
  State state = State::incomplete;
  Message message;
  std::size_t bytes = 0;
};
[[nodiscard]] ParsedMessage first_message(View stream);

}  // namespace verisim::vrpn
