#include "firmware_sim/firmware/firmware.hpp"

#include "firmware_sim/firmware/arithmetic.hpp"

namespace verisim {
namespace firmware {
namespace {

/// RPM, rounded half away from zero, for a report.
int16_t rpm_of(int32_t velocity) {
  const int32_t rpm = rounded(velocity, kPerRpm);
  if (rpm > INT16_MAX) return INT16_MAX;
  return rpm < INT16_MIN ? static_cast<int16_t>(INT16_MIN) : static_cast<int16_t>(rpm);
}

}  // namespace

bool Firmware::work() {
  const uint8_t until = heard_until_;
  if (silent_ms_ < kWatchdogMs) ++silent_ms_;
  uint8_t byte;
  while (in_.take_before(until, byte)) {
    (void)receiver_.append(&byte, 1);
    (void)receiver_.process(*this);
  }
  if (--to_work_ms_ != 0) return false;
  to_work_ms_ = kSampleMs;
  sample();
  return true;
}

void Firmware::operator()(const protocol::XYFloatError& error) {
  command_for_error(error.x, error.y, 0);
}

void Firmware::operator()(const protocol::XYRotationFloatError& error) {
  command_for_error(error.x, error.y, error.rotation);
}

void Firmware::operator()(const protocol::StartControl& /*message*/) {
  is_on_ = true;
  is_at_fault_ = false;
  command(0, 0, 0);
}

void Firmware::operator()(const protocol::EndControl& /*message*/) {
  is_on_ = false;
  command(0, 0, 0);
}

void Firmware::command_for_error(const float& x, const float& y, const float& rotation) {
  int32_t vx;
  int32_t vy;
  int32_t omega;
  if (velocity_for_error(x, vx) && velocity_for_error(y, vy) && velocity_for_error(rotation, omega))
    command(vx, vy, omega);
}

void Firmware::command(int32_t vx, int32_t vy, int32_t omega) {
  silent_ms_ = 0;
  share_ = kStopSteps;
  target_ = setpoints_for(vx, vy, omega);
  if (is_on_ && !is_at_fault_) return;
  for (int32_t& wheel : target_.wheels) wheel = 0;
}

int32_t Firmware::setpoint_of(uint8_t wheel) const {
  return share_ == kStopSteps ? target_.wheels[wheel] : target_.wheels[wheel] * share_ / kStopSteps;
}

void Firmware::sample() {
  if (silent_ms_ >= kWatchdogMs && share_ > 0) --share_;
  bool contradicts = false;
  for (uint8_t wheel = 0; wheel < kWheels; ++wheel) {
    const Encoder& encoder = sampled_[wheel];  // the interrupt writes it again when this has long been done
    if (is_on_ && !is_at_fault_) {
      duty_[wheel] = drives_[wheel].update(encoder, sampled_ms_, setpoint_of(wheel));
    } else {
      drives_[wheel].idle(encoder, sampled_ms_);
      duty_[wheel] = 0;
    }
    contradicts = contradicts || drives_[wheel].contradicts();
  }
  if (!contradicts) return;
  is_at_fault_ = true;
  for (uint8_t wheel = 0; wheel < kWheels; ++wheel) target_.wheels[wheel] = duty_[wheel] = 0;
}

void Firmware::report() {
  if (--to_report_ms_ != 0) return;
  to_report_ms_ = kReportMs;
  protocol::CurrentWheelSetpoints setpoints;
  protocol::CurrentWheelVelocities velocities;
  protocol::CurrentPWMOutput pwm;
  for (uint8_t wheel = 0; wheel < kWheels; ++wheel) {
    setpoints.wheels[wheel] = rpm_of(setpoint_of(wheel));
    velocities.wheels[wheel] = rpm_of(drives_[wheel].velocity());
    pwm.wheels[wheel] = duty_[wheel];
  }
  send(setpoints);
  send(velocities);
  send(pwm);
}

template <typename Report>
void Firmware::send(const Report& report) {
  uint8_t frame[protocol::longest_frame<protocol::RobotToComputer>()];
  const uint8_t length = protocol::encode<protocol::RobotToComputer>(report, frame);
  if (out_.space() < length) return;  // the line is slower than the reports: a whole one is left out
  for (uint8_t i = 0; i < length; ++i) (void)out_.put(frame[i]);
}

}  // namespace firmware
}  // namespace verisim
