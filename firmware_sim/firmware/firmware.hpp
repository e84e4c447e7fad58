// firmware_sim/firmware/firmware.hpp
// The robot's firmware, one source for every board: interrupts hand it edges, bytes and milliseconds; its main loop
// does one millisecond's work at a time. C++14 without standard library, exceptions, heap or RTTI; integers only, so
// that every board computes the same. A board calls, per millisecond, tick() from its timer's interrupt and then
// work().
//
// Commands (protocol/messages.hpp has the units):
// - Velocities move the robot while the controller is on; while it is off they count as heard and are not kept.
// - Errors are times 5000 1/s velocities. NaN in a field refuses the message: it counts as not heard.
// - What is beyond the wheels' reach, infinity too, is limited: same direction, fastest wheel at 7000 RPM.
// - StartControl turns the controller on, from standstill, and forgets a fault. EndControl turns it off: the motors get
//   nothing. After a reset it is off.
// - Watchdog: kWatchdogMs without an accepted command bring the setpoints evenly to 0 within kStopSteps samples. The
//   next command goes on.
// - A wheel that contradicts its drive (drive.hpp) stops all four at once, until StartControl: a base with three wheels
//   goes where nobody sent it.
// Reports every kReportMs: setpoints in force (0 while off, stopped or at fault: that is how the robot says it),
// velocities, PWM. A setpoint that stays 0 against what is commanded asks for StartControl.
#pragma once

#include "firmware_sim/firmware/drive.hpp"
#include "firmware_sim/firmware/mecanum.hpp"
#include "firmware_sim/firmware/ring.hpp"
#include "firmware_sim/protocol/frame.hpp"

namespace verisim {
namespace firmware {

class Firmware {
 public:
  /// `encoders`: counted up by the board's interrupts.
  explicit Firmware(Encoder (&encoders)[kWheels]) : encoders_(encoders) {}

  // From interrupts ------------------------------------------------------------------------------------------------

  /// A byte has arrived; false if there was no room for it.
  bool byte_arrived(uint8_t byte) { return in_.put(byte); }

  /// A millisecond has begun. What has arrived and what was counted before belongs to its work, however late that is.
  void tick() {
    now_ms_ = static_cast<uint16_t>(now_ms_ + 1);
    heard_until_ = in_.mark();
    if (--to_sample_ms_ != 0) return;
    to_sample_ms_ = kSampleMs;
    sampled_ms_ = now_ms_;
    for (uint8_t wheel = 0; wheel < kWheels; ++wheel) sampled_[wheel] = encoders_[wheel];
  }

  uint16_t now_ms() const { return now_ms_; }

  /// The next byte to send, if there is one.
  bool next_byte(uint8_t& byte) { return out_.take(byte); }
  bool has_bytes() const { return !out_.is_empty(); }

  // From the main loop ---------------------------------------------------------------------------------------------

  /// The work of the millisecond that tick() has begun: commands, and every kSampleMs the wheels. True if it was a
  /// sample: the motors' PWM is new.
  bool work();

  /// To be called once a millisecond, when the motors have their PWM: sends a report if one is due.
  void report();

  const int16_t (&duty() const)[kWheels] { return duty_; }

  // What the receiver calls.
  void operator()(const protocol::XYFloatError& error);
  void operator()(const protocol::XYRotationFloatError& error);
  void operator()(const protocol::XYIntVelocities& v) { command(v.x, v.y, 0); }
  void operator()(const protocol::XYRotationIntVelocities& v) { command(v.x, v.y, v.rotation); }
  void operator()(const protocol::StartControl&);
  void operator()(const protocol::EndControl&);

 private:
  void command(int32_t vx, int32_t vy, int32_t omega);
  void command_for_error(const float& x, const float& y, const float& rotation);
  void sample();
  int32_t setpoint_of(uint8_t wheel) const;
  template <typename Report>
  void send(const Report& report);

  Encoder (&encoders_)[kWheels];
  Ring<64> in_;
  Ring<128> out_;  ///< two reports
  protocol::Receiver<protocol::ComputerToRobot> receiver_;
  Drive drives_[kWheels];
  Setpoints target_{{0, 0, 0, 0}};  ///< as commanded
  int16_t duty_[kWheels] = {0, 0, 0, 0};
  uint16_t silent_ms_ = 0;    ///< since the last accepted command
  Encoder sampled_[kWheels];  ///< as they were when the sample began
  uint16_t sampled_ms_ = 0;
  volatile uint16_t now_ms_ = 0;
  volatile uint8_t heard_until_ = 0;
  uint8_t to_sample_ms_ = kSampleMs;  ///< of the interrupt
  uint8_t to_work_ms_ = kSampleMs;    ///< of the main loop
  uint8_t to_report_ms_ = kReportMs;
  uint8_t share_ = kStopSteps;  ///< of the target that is in force, in kStopSteps: the watchdog takes it down
  bool is_on_ = false;
  bool is_at_fault_ = false;
};

}  // namespace firmware
}  // namespace verisim
