// firmware_sim/avr/chip.hpp
// An ATmega328P under simavr 1.6 with the firmware's machine code: what the simulator leaves out is put right here.
// - It charges no cycles for entering an interrupt: 4 are added.
// - Its sleep waits for the wall clock: replaced by one that only counts.
// - Its serial line takes 11 bits a byte and holds 64 bytes: bytes are put into the receiver when they arrive, at most
//   three unread as in the hardware, and leave at the hardware's pace.
// - It looks at INT0 and INT1 in every cycle while they are low, though nobody has enabled them: told not to, which
//   makes it several times faster.
// - It does not play phase-correct PWM: the duty is read from the compare registers.
// - It forgets the levels of input pins at reset: they are applied again.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <string>

#include "firmware_sim/avr/wire.hpp"

struct avr_t;
struct avr_irq_t;
struct avr_uart_t;

namespace verisim::firmware {

class Chip {
 public:
  /// Boots the program of an ELF file. Throws std::runtime_error that says what is wrong.
  explicit Chip(const std::string& elf);
  ~Chip();
  Chip(const Chip&) = delete;
  Chip& operator=(const Chip&) = delete;

  void advance(std::span<const EncoderEdge> edges, std::span<const TimedByte> in);
  void reset();
  void set_powered(bool on);
  const Reply& state() const { return state_; }

 private:
  struct Hooks;  ///< what simavr calls
  friend struct Hooks;
  struct Leaving {
    std::uint64_t cycle;
    std::uint8_t value;
  };

  void boot();
  void run_until(std::uint64_t cycle);
  void apply(const EncoderEdge& edge, bool anew);
  void arrive(const TimedByte& byte);
  std::uint64_t next_event() const;
  void apply_events(std::uint64_t until);
  void read_outputs();
  void read_losses();
  std::uint16_t word_at(std::uint32_t address) const;

  avr_t* avr_ = nullptr;
  avr_uart_t* uart_ = nullptr;
  std::array<std::array<avr_irq_t*, 2>, 4> pins_{};  ///< A and B of each encoder
  std::uint32_t encoders_ = 0, bytes_lost_ = 0;      ///< addresses of the firmware's variables
  std::uint64_t begin_ = 0;                          ///< cycle at which this millisecond begins
  std::uint64_t clock_began_ = 0;                    ///< cycle at which the firmware started its clock
  bool is_powered_ = true;

  std::span<const EncoderEdge> edges_;
  std::span<const TimedByte> bytes_;
  std::array<std::uint8_t, 4> levels_{};
  std::array<std::uint16_t, 4> expected_{};  ///< what the encoders' counts should be
  std::uint64_t edges_lost_before_ = 0;      ///< before the last boot
  std::uint32_t awake_ms_ = 0;               ///< milliseconds since it slept last
  std::uint16_t bytes_lost_seen_ = 0;

  std::deque<Leaving> leaving_;
  std::uint64_t line_is_free_ = 0;
  std::uint64_t slept_ = 0, slept_before_ = 0, entered_ = 0, last_sample_ = 0;
  Reply state_{};
};

}  // namespace verisim::firmware
