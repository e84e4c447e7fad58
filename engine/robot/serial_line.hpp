// One direction of a serial line, 8N1: a sender's buffer, a wire, and the receiver's UART, which samples the wire in
// the middle of its own bits as the data sheet of the ATmega328P says (section "Asynchronous Data Reception"). If both
// ends agree about the baud rate the bytes come through; if they do not, the receiver reads what such a UART reads.
//
// Time is counted in cycles of 16 MHz within a millisecond, exactly: bit k of a byte begins at a fraction of a cycle.
// Order of a millisecond: send what was handed over in it, then advance(), which gives what arrives in it.
// No allocation after construction. About 0.1 us a byte.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "engine/base/random.hpp"
#include "engine/robot/clock.hpp"
#include "engine/robot/notes.hpp"
#include "firmware_sim/board.hpp"

namespace verisim::robot {

using firmware::TimedByte;

struct SerialLineSettings {
  std::uint32_t baud = 115'200;  ///< bit/s of the sender: the published default (a board: 117647). In [1200, 2000000]
  std::uint32_t receiver_baud = 115'200;  ///< bit/s of the receiver. In the same range
  double latency = 0.001;                 ///< s; USB bridges wait 1 to 16 ms, Bluetooth RFCOMM longer. At most 1
  double loss = 0;                        ///< fraction of bytes that never reach the wire
  double corruption = 0;                  ///< fraction of bits on the wire, start and stop included, that are inverted
  std::uint32_t buffer = 256;             ///< bytes that the sender holds, the one under way included. 1 to 65536
};

struct SerialLineCounts {
  std::uint64_t sent = 0;            ///< handed over
  std::uint64_t overflowed = 0;      ///< of them: did not fit into the sender's buffer
  std::uint64_t lost = 0;            ///< of them: by loss or while unplugged
  std::uint64_t damaged = 0;         ///< of those on the wire: with a bit inverted
  std::uint64_t framing_errors = 0;  ///< seen by the receiver and dropped: no start bit, or no stop bit
  std::uint64_t received = 0;        ///< given to the receiver
};

class SerialLine {
 public:
  /// `name` names the line's random streams. Error(input) for settings out of the ranges above.
  SerialLine(const SerialLineSettings& settings, std::uint64_t seed, std::string_view name);

  /// Hands bytes to the sender at the beginning of the millisecond that comes next.
  void send(std::span<const std::uint8_t> bytes);
  /// The same for bytes that a board gave at their own times in it. @pre cycles do not fall
  void send(std::span<const TimedByte> bytes);
  /// Takes one millisecond. What the receiver has taken in it, by time; valid until the next call.
  [[nodiscard]] std::span<const TimedByte> advance();

  /// While unplugged, what is sent is lost and counted; the receiver hears silence.
  void plug(bool is_plugged) { is_plugged_ = is_plugged; }
  [[nodiscard]] bool is_plugged() const { return is_plugged_; }
  [[nodiscard]] const SerialLineCounts& counts() const { return counts_; }
  /// Says when the line begins to lose bytes, and when it has lost none for a second.
  void report(RobotNotes& notes) { losing_.report(notes); }

 private:
  // Time here is counted in units of 1 / (16 MHz x baud): bits and cycles are whole numbers of them.
  struct Sent {
    std::uint64_t start;  ///< when its start bit reaches the receiver
    std::uint32_t bits;   ///< start bit first, ten of them
  };
  void put(std::uint64_t at, std::uint8_t value);
  void pop();
  [[nodiscard]] const Sent& sent(std::size_t i) const { return wave_[(first_ + i) & (wave_.size() - 1)]; }
  [[nodiscard]] bool find_edge(std::uint64_t& edge) const;
  [[nodiscard]] bool level(std::uint64_t at) const;
  [[nodiscard]] bool take_byte(std::uint64_t horizon);

  SerialLineSettings settings_;
  RandomStream losses_, flips_;
  std::uint64_t unit_per_cycle_, latency_, half_bit_;  ///< half_bit_: of the receiver
  std::uint64_t now_ = 0, free_ = 0;                   ///< begin of this millisecond; when the wire is free
  std::vector<Sent> wave_;                             ///< ring, a power of two: what the receiver has not passed yet
  std::size_t first_ = 0, count_ = 0;
  std::uint64_t passed_until_ = 0;  ///< end of the last byte that left the ring
  bool passed_low_ = false;         ///< and the level at its end
  std::uint64_t listen_ = 0;        ///< the receiver has sampled up to here
  std::vector<TimedByte> received_;
  SerialLineCounts counts_;
  bool is_plugged_ = true;
  std::uint64_t millisecond_ = 0, losses_seen_ = 0;
  Spell losing_{"serial line", "loses bytes", "loses no bytes any more", 1000};
};

}  // namespace verisim::robot
