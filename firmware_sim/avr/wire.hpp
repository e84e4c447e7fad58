// firmware_sim/avr/wire.hpp
// What an AVR board and verisim-avr say to each other over its stdin and stdout: one request, one reply, both on one
// machine and from one build, so in memory's own form. A first reply comes unasked: the controller has booted.
#pragma once

#include <type_traits>

#include "firmware_sim/board.hpp"

namespace verisim::firmware {

enum class Ask : std::uint32_t { advance, reset, power_on, power_off };

/// Followed by its edges, then its bytes.
struct Request {
  Ask ask;
  std::uint32_t edges, bytes;
};

struct Reply {
  BoardLoad load;
  std::array<std::int16_t, 4> duty;
  std::uint32_t sent_count;
  std::array<TimedByte, kCyclesPerMs / kCyclesPerByte + 1> sent;
};

static_assert(std::is_trivially_copyable_v<Request> && std::is_trivially_copyable_v<Reply>);
inline constexpr std::uint32_t kEventsMax = 1U << 16;  ///< in a millisecond: more edges than cycles are no encoder's

}  // namespace verisim::firmware
