// Slower clocks beside the loop: script frames, trackers, firmware. Same thread, fixed order, no drift.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace verisim {

/// Runs functions at rates of their own. Tick k of a clock is due at the first frame whose end is not before k / rate,
/// decided in integers (nanoseconds and millihertz), so that 60 Hz stays 60 Hz for ever.
class Clocks {
 public:
  explicit Clocks(double dt);
  /// Ticks are numbered from 1: the first is due 1 / rate after the start. Error(input) unless 0.001 <= rate <= 1e6 Hz.
  /// @pre f is not empty
  void add(double rate_hz, std::function<void(double)> f);
  /// Runs everything that is due at the end of frame number `frames` (frames computed so far), in the order of adding.
  void run_due(std::uint64_t frames, double t);

 private:
  struct Clock {
    std::uint64_t rate_mhz;
    std::uint64_t next;
    std::function<void(double)> f;
  };
  std::uint64_t dt_ns_;
  std::vector<Clock> clocks_;
};

}  // namespace verisim
