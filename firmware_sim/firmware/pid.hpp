// firmware_sim/firmware/pid.hpp
// The controller of one wheel's velocity: proportional, integral, derivative on the measurement (a step of the setpoint
// gives no kick), as the published library (a fork of Arduino PID 1.0.1): u = Kp e + I - Kd' (y - y'), I = sum of Ki'
// e, both I and u within the limits; Ki' = Ki T, Kd' = Kd / T with the sample time T. Integers, not float: the same
// bits on every board, and on the AVR 1/4 of the cycles (README.md has the measurement).
#pragma once

#include <stdint.h>

namespace verisim {
namespace firmware {

/// In 1/65536 of PWM per RPM. At an error of 14,000 RPM the sum must stay below 2047: Kp + Kd' < 0.1.
struct Gains {
  int32_t kp, ki_t, kd_t;
};

/// Units: setpoint and velocity RPM/16, output 1/2^20 of PWM.
class Pid {
 public:
  static constexpr int32_t kOne = 1L << 20;  ///< one step of PWM

  /// Anti-windup beyond the published clamp of the integral: while the output is at a limit, an error that pushes it
  /// further is not summed up. `low` and `high` in units of the output.
  enum class Windup : uint8_t { clamp, clamp_and_hold };

  constexpr explicit Pid(const Gains& gains, Windup windup) : gains_(gains), windup_(windup) {}

  int32_t update(int32_t setpoint, int32_t velocity, int32_t low, int32_t high) {
    const int32_t error = setpoint - velocity;
    const int32_t before = integral_;
    integral_ = clamped(integral_ + gains_.ki_t * error, low, high);
    const int32_t wanted = gains_.kp * error + integral_ - gains_.kd_t * (velocity - velocity_);
    velocity_ = velocity;
    const bool pushes_on = (wanted > high && error > 0) || (wanted < low && error < 0);
    if (windup_ == Windup::clamp_and_hold && pushes_on) integral_ = clamped(before, low, high);
    return clamped(wanted, low, high);
  }

  /// Begins anew at this velocity, with nothing summed up.
  void reset(int32_t velocity) {
    integral_ = 0;
    velocity_ = velocity;
  }

 private:
  static constexpr int32_t clamped(int32_t value, int32_t low, int32_t high) {
    return value < low ? low : value > high ? high : value;
  }

  Gains gains_;
  Windup windup_;
  int32_t integral_ = 0;
  int32_t velocity_ = 0;  ///< of the last sample
};

}  // namespace firmware
}  // namespace verisim
