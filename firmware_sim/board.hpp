// firmware_sim/board.hpp
// A controller board with the robot's firmware on it, in lock-step with whoever drives it: one millisecond at a time,
// edges of the encoders and bytes of the serial line in, bytes and PWM out. Two of them: `host` runs the firmware as
// plain functions (for speed), `avr` its machine code on a simulated ATmega328P at 16 MHz. Both are deterministic: what
// comes out depends on what goes in alone. Wheels: 0 front left, 1 front right, 2 rear left, 3 rear right.
//
// Cycles are those of the board's clock within the millisecond, 0 to 15,999. The serial line has 115,200 baud by name;
// the controller's divider makes 117,647 of it, 1360 cycles a byte, and that is the pace of what it sends. A
// millisecond begins with the commands that came before it and, every 5 ms, a sample of the wheels; the PWM of a
// sample is on the motors one millisecond after it, on both boards.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace verisim::firmware {

inline constexpr std::uint32_t kClockHz = 16'000'000, kCyclesPerMs = 16'000;
inline constexpr std::uint32_t kCyclesPerByte = 1360;  ///< 8 data bits, start, stop; divider 17 of 8 clocks a bit

/// One change of one encoder's levels: bit 0 A, bit 1 B, after it. A leads B when the motor drives the robot forward.
struct EncoderEdge {
  std::uint32_t cycle;
  std::uint8_t wheel;
  std::uint8_t levels;
};

/// To the board: when its last bit has arrived. From the board: when its last bit has left.
struct TimedByte {
  std::uint32_t cycle;
  std::uint8_t value;
};

/// Since the board was made. The host board, whose code takes no time, has no busy cycles.
struct BoardLoad {
  std::uint64_t cycles = 0;                                      ///< powered
  std::uint64_t busy_cycles = 0;                                 ///< not asleep; interrupts included
  std::uint64_t interrupt_cycles = 0;                            ///< in interrupts, entry and exit included
  std::uint64_t edges_seen = 0;                                  ///< given to the board while it ran
  std::uint64_t edges_lost = 0;                                  ///< of these, that its counts do not show
  std::uint64_t bytes_lost = 0;                                  ///< arrived with no room for them
  std::uint32_t control_period_min = 0, control_period_max = 0;  ///< cycles from one sample to the next; 0 before two
};

class Board {
 public:
  virtual ~Board() = default;
  virtual const char* described() const = 0;

  /// One millisecond. Allocates nothing. @pre both sorted by cycle, each cycle below kCyclesPerMs, wheel 0 to 3
  virtual void advance(std::span<const EncoderEdge> edges, std::span<const TimedByte> in) = 0;

  virtual std::span<const TimedByte> sent() const = 0;          ///< what left the board in the last millisecond
  virtual const std::array<std::int16_t, 4>& duty() const = 0;  ///< PWM -255 to 255 at its end
  virtual const BoardLoad& load() const = 0;
  virtual void reset() = 0;               ///< as by the reset button or after a brown-out: its memory is lost
  virtual void set_powered(bool on) = 0;  ///< off: outputs 0, hears nothing; on again: boots
};

std::unique_ptr<Board> make_host_board();

/// `program`: path of verisim-avr, which it starts and which ends with the board. Throws std::runtime_error that says
/// what is missing; advance() does so if the program ends or does not answer.
std::unique_ptr<Board> make_avr_board(const std::string& program);

}  // namespace verisim::firmware
