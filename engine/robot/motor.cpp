#include "engine/robot/motor.hpp"

#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim::robot {

double dry_friction(const MotorParameters& motor) {
  const double k = motor.torque_constant;
  return k * (motor.nominal_voltage - k * motor.no_load_speed) / motor.resistance;
}

Winding::Winding(const MotorParameters& motor, const BridgeParameters& bridge, double step)
    : k_(motor.torque_constant),
      inductance_(motor.inductance),
      drop_(bridge.drop),
      resistance_(motor.resistance + bridge.drop_per_ampere) {
  VERISIM_ASSERT(is_positive(step));
  VERISIM_ASSERT(is_positive(motor.resistance));
  VERISIM_ASSERT(is_positive(motor.inductance));
  VERISIM_ASSERT(is_not_negative(bridge.drop));
  VERISIM_ASSERT(is_not_negative(bridge.drop_per_ampere));
  const double steps_per_time_constant = inductance_ / resistance_ / step;
  decay_ = pinned::exp(-1 / steps_per_time_constant);
  mean_decay_ = (1 - decay_) * steps_per_time_constant;
  mean_square_decay_ = (1 - decay_ * decay_) * steps_per_time_constant / 2;
}

WindingTorque Winding::begin(double voltage, double speed) {
  const double push = voltage - k_ * speed;  // what the bridge's drop still works against
  lost_at_reversal_ = 0;
  direction_ = current_ > 0 ? 1 : current_ < 0 ? -1 : 0;
  if (direction_ != 0) {
    const double settled = (push - direction_ * drop_) / resistance_;
    if (direction_ * (settled + (current_ - settled) * decay_) < 0) {
      lost_at_reversal_ = inductance_ * current_ * current_ / 2;
      current_ = 0;
      direction_ = 0;
    }
  }
  if (direction_ == 0) direction_ = push > drop_ ? 1 : push < -drop_ ? -1 : 0;
  if (direction_ == 0) return {};
  drive_ = voltage - direction_ * drop_;
  const double conductance = (1 - mean_decay_) / resistance_;
  return {k_ * (conductance * drive_ + mean_decay_ * current_), k_ * k_ * conductance};
}

WindingStep Winding::end(double speed) {
  if (direction_ == 0) return {};
  const double settled = (drive_ - k_ * speed) / resistance_;
  const double change = current_ - settled;
  current_ = settled + change * decay_;
  return {settled + change * mean_decay_,
          settled * settled + 2 * settled * change * mean_decay_ + change * change * mean_square_decay_};
}

}  // namespace verisim::robot
