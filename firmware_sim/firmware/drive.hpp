// firmware_sim/firmware/drive.hpp
// One wheel: its velocity, its controller, what it gives the motor, and whether what comes back can be true.
// Layers, from outside: setpoint -> feed-forward (what the motor needs by its data sheet) + PI(D) -> limit -> signed
// PWM. C++14 without standard library.
#pragma once

#include "firmware_sim/firmware/pid.hpp"
#include "firmware_sim/firmware/velocity.hpp"

namespace verisim {
namespace firmware {

class Drive {
 public:
  /// One sample. `setpoint` RPM/16; gives the PWM, -255 to 255. With setpoint 0 it lets go below kStandstillRpm.
  int16_t update(const Encoder& encoder, uint16_t now_ms, int32_t setpoint);

  /// Measures only; the motor gets nothing and the controller begins anew when it is used again.
  void idle(const Encoder& encoder, uint16_t now_ms);

  int32_t velocity() const { return velocity_; }  ///< RPM/16

  /// Driven hard, but no count for kStalledMs (dead encoder, cut cable, stalled motor), or turning against its drive
  /// for kReversedMs (reversed encoder or motor). Until idle().
  bool contradicts() const { return contradicts_; }

 private:
  void watch(const Encoder& encoder);

  VelocityEstimator estimator_;
  Pid pid_{kWheelGains, Pid::Windup::clamp_and_hold};
  int32_t velocity_ = 0;
  int16_t duty_ = 0;
  int16_t count_ = 0;  ///< of the last sample
  uint8_t still_ = 0;  ///< samples that the drive was hard and nothing counted
  uint8_t against_ = 0;
  bool contradicts_ = false;

 public:
  /// Kp 0.05 PWM/RPM, Ki 1.2 PWM/RPM/s: chosen on the bench of the tests for a motor under the robot (60 ms), with
  /// which a motor alone (6 ms) is still stable (at Kp 0.07 it is not). Kd 0: edges that jitter make noise of it.
  static constexpr Gains kWheelGains = {3277, 400, 0};
  /// Volts per RPM by the data sheet, 12 V at 8100 RPM, and part of the bridge's drop of 2 V: less than is needed, so
  /// that the integral never has to take back what was given too much.
  static constexpr int32_t kFeedForward = 33010 / kPerRpm;  ///< 255/8100 PWM per RPM, in 1/2^20 per RPM/16
  static constexpr int16_t kBridgePwm = 24;
};

}  // namespace firmware
}  // namespace verisim
