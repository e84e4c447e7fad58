// firmware_sim/firmware/encoder.hpp
// Quadrature decoding in the pin-change interrupt: counts every edge of A and B and remembers when the last one came.
// Levels: bit 0 is A, bit 1 is B. Positive: A leads B, so 0, 1, 3, 2, 0; that is the robot driven forward at this
// wheel. C++14 without standard library. About 40 cycles of an AVR an edge.
#pragma once

#include <stdint.h>

namespace verisim {
namespace firmware {

/// What an interrupt knows of an encoder. Its layout is the same on every board: `verisim-avr` reads it from the
/// controller's memory to see whether an edge was lost.
struct Encoder {
  int16_t count = 0;     ///< edges forward less edges backward; wraps
  uint16_t ms = 0;       ///< when the last one came: millisecond since the start, wraps after 65 s,
  uint16_t illegal = 0;  ///< times that A and B changed at once: two edges in one, direction unknown, not counted
  uint8_t tick = 0;      ///< and tick in that millisecond
  uint8_t levels = 0;    ///< as last seen

  void edge(uint8_t now, uint16_t at_ms, uint8_t at_tick) {
    const auto changed = static_cast<uint8_t>(levels ^ now);
    const bool is_backward = ((levels ^ static_cast<uint8_t>(now >> 1)) & 1) != 0;  // A before differs from B after
    levels = now;
    if (changed == 3) {
      ++illegal;
      return;
    }
    if (changed == 0) return;  // there and back before the interrupt looked
    if (is_backward)
      --count;
    else
      ++count;
    ms = at_ms;
    tick = at_tick;
  }
};
static_assert(sizeof(Encoder) == 8, "no padding on any board");

}  // namespace firmware
}  // namespace verisim
