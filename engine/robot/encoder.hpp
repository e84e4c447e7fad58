// Quadrature encoders at the motors: 12 lines, 48 counts a turn (dissertation section 5.3.1; ORACLES sections 2
// and 3.4). Times in cycles of the robot's 16 MHz clock, within the millisecond.
//
//   count mod 4:    0  1  2  3  0        A leads B when the motor drives the robot forward.
//   A (bit 0):     _|~~~~~~|_____|
//   B (bit 1):     ____|~~~~~~|__
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/robot/clock.hpp"

namespace verisim::robot {

inline constexpr double kCountsPerTurn = 48;  ///< of the motor
using Edge = firmware::EncoderEdge;

enum class EncoderFault : std::uint8_t {
  none,
  dead,     ///< its signals no longer change
  reversed  ///< A and B are swapped
};

/// The edges of a millisecond, by cycle, of equal cycles by the order in which they were added. Never allocates.
/// Room for 9 times the robot's top speed on all wheels; what does not fit is counted, not stored.
class Edges {
 public:
  void clear() { size_ = 0; }
  void add(const Edge& edge);
  [[nodiscard]] std::span<const Edge> all() const { return {edges_.data(), size_}; }
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }  ///< since it was made

 private:
  std::array<Edge, 256> edges_;
  std::size_t size_ = 0;
  std::uint64_t dropped_ = 0;
};

/// One encoder. Begins between two edges: a motor that trembles by less than half a count gives none.
class Encoder {
 public:
  explicit Encoder(std::uint8_t wheel) : wheel_(wheel) {}

  /// The motor turns by `angle` [rad], evenly, from cycle `begin` of this millisecond for `cycles` cycles.
  void turn(double angle, std::uint32_t begin, std::uint32_t cycles, Edges& edges);

  /// From now on. What was counted stays.
  void set_fault(EncoderFault fault) { fault_ = fault; }
  [[nodiscard]] EncoderFault fault() const { return fault_; }

  /// What a decoder that misses nothing has counted from the edges so far.
  [[nodiscard]] std::int64_t counts() const { return counts_; }
  /// The signals now.
  [[nodiscard]] std::uint8_t levels() const;

 private:
  double fraction_ = 0.5;  ///< of a count, in [0, 1)
  std::int64_t counts_ = 0;
  std::uint8_t wheel_;
  EncoderFault fault_ = EncoderFault::none;
};

}  // namespace verisim::robot
