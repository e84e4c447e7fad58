// tests/firmware_sim/bench_robot.hpp
// A robot on a test bench: four motors as first-order systems that turn encoders. Just enough to close the loop around
// a board; the plant that scenes use is another.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "firmware_sim/board.hpp"
#include "firmware_sim/protocol/frame.hpp"

namespace verisim::firmware::bench {

struct Motor {
  double tau_s = 0.006;  ///< 6 ms: the motor alone; about 60 ms: under the robot
  double drop_v = 1.6;   ///< of the bridge
  double rpm = 0;
  double counts = 0;  ///< position, in edges
  bool is_stalled = false, encoder_is_dead = false, encoder_is_reversed = false;

  static constexpr double kRpmPerVolt = 8100 / 12.0;

  void advance(double duty, double dt_s) {
    const double v = 12.0 * duty / 255;
    const double at_motor = std::abs(v) <= drop_v ? 0 : v - std::copysign(drop_v, v);
    rpm += (at_motor * kRpmPerVolt - rpm) * (dt_s / tau_s);
    if (is_stalled) rpm = 0;
    counts += rpm / 60 * 48 * dt_s;
  }
};

/// The levels of an encoder whose edges are counted: 0, 1, 3, 2.
inline std::uint8_t levels_of(std::int64_t count) {
  constexpr std::array<std::uint8_t, 4> kGray{0, 1, 3, 2};
  return kGray[static_cast<std::size_t>(count & 3)];
}

class Robot {
 public:
  std::array<Motor, 4> motors;

  /// A millisecond under this PWM, in steps of 1/16 ms; the edges come in order.
  std::span<const EncoderEdge> advance(const std::array<std::int16_t, 4>& duty) {
    edges_.clear();
    constexpr int kSteps = 64;
    for (int step = 0; step < kSteps; ++step) {
      for (std::uint8_t wheel = 0; wheel < 4; ++wheel) {
        Motor& motor = motors[wheel];
        motor.advance(duty[wheel], 1e-3 / kSteps);
        const auto now = static_cast<std::int64_t>(std::floor(motor.counts));
        while (now != count_[wheel]) {
          count_[wheel] += now > count_[wheel] ? 1 : -1;
          const std::int64_t seen = motor.encoder_is_reversed ? -count_[wheel] : count_[wheel];
          if (!motor.encoder_is_dead)
            edges_.push_back(
                {static_cast<std::uint32_t>(step) * kCyclesPerMs / kSteps + 13U * wheel, wheel, levels_of(seen)});
        }
      }
    }
    return edges_;
  }

 private:
  std::array<std::int64_t, 4> count_{};
  std::vector<EncoderEdge> edges_;
};

/// What a computer hears.
struct Heard {
  std::array<std::int16_t, 4> setpoints{}, velocities{}, pwm{};
  int reports = 0;
  void operator()(const protocol::CurrentWheelSetpoints& m) {
    std::copy_n(m.wheels, 4, setpoints.begin());
    ++reports;
  }
  void operator()(const protocol::CurrentWheelVelocities& m) { std::copy_n(m.wheels, 4, velocities.begin()); }
  void operator()(const protocol::CurrentPWMOutput& m) { std::copy_n(m.wheels, 4, pwm.begin()); }
};

/// The computer's end of the serial line: sends frames at the line's pace, hears reports.
class Line {
 public:
  Heard heard;
  protocol::Receiver<protocol::RobotToComputer> receiver;

  template <typename Message>
  void send(const Message& message) {
    std::uint8_t frame[protocol::longest_frame<protocol::ComputerToRobot>()];
    const std::uint8_t length = protocol::encode<protocol::ComputerToRobot>(message, frame);
    send_bytes({frame, length});
  }
  void send_bytes(std::span<const std::uint8_t> bytes) { waiting_.insert(waiting_.end(), bytes.begin(), bytes.end()); }

  /// What arrives in the next millisecond, 1389 cycles apart.
  std::span<const TimedByte> next() {
    bytes_.clear();
    while (!waiting_.empty() && free_ + 1389 < kCyclesPerMs) {
      free_ += 1389;
      bytes_.push_back({free_, waiting_.front()});
      waiting_.erase(waiting_.begin());
    }
    free_ = free_ > kCyclesPerMs ? free_ - kCyclesPerMs : 0;
    return bytes_;
  }

  void hear(std::span<const TimedByte> sent) {
    for (const TimedByte& byte : sent) receiver.feed(&byte.value, 1, heard);
  }

 private:
  std::vector<std::uint8_t> waiting_;
  std::vector<TimedByte> bytes_;
  std::uint32_t free_ = 0;
};

/// Board, motors and line, closed.
class Bench {
 public:
  explicit Bench(std::unique_ptr<Board> its_board) : board(std::move(its_board)) {}

  std::unique_ptr<Board> board;
  Robot robot;
  Line line;

  void millisecond() {
    board->advance(robot.advance(board->duty()), line.next());
    line.hear(board->sent());
  }
  void run(int ms) {
    for (int i = 0; i < ms; ++i) millisecond();
  }
  /// The same command again and again, as a server sends it.
  template <typename Message>
  void drive(const Message& message, int ms) {
    for (int i = 0; i < ms; ++i) {
      if (i % 50 == 0) line.send(message);
      millisecond();
    }
  }
};

}  // namespace verisim::firmware::bench
