#include "engine/robot/plant.hpp"

#include <cmath>
#include <cstdlib>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim::robot {
namespace {

const PlantParameters& checked(const PlantParameters& parameters) {
  check(parameters);
  return parameters;
}

}  // namespace

Plant::Plant(const PlantParameters& parameters)
    : parameters_(checked(parameters)),
      h_(1e-3 / parameters.substeps),
      base_(parameters, h_),
      winding_{Winding(parameters.motor, parameters.bridge, h_), Winding(parameters.motor, parameters.bridge, h_),
               Winding(parameters.motor, parameters.bridge, h_), Winding(parameters.motor, parameters.bridge, h_)},
      encoder_{Encoder(0), Encoder(1), Encoder(2), Encoder(3)} {
  for (std::size_t i = 0; i < kWheels; ++i) {
    const auto [x, y] = wheel_place(parameters.geometry, i).p;
    per_moment_[i] = {1 / (4 * x), 1 / (4 * y)};
  }
  state_.load = loads({});
  state_.supply_voltage = parameters.supply.voltage;
  place({});
}

void Plant::place(const PlanarPose& pose) {
  VERISIM_ASSERT(std::isfinite(pose.x + pose.y + pose.theta));
  const auto [cx, cy] = parameters_.body.centre_of_mass;
  const double c = pinned::cos(pose.theta), s = pinned::sin(pose.theta);
  x_ = pose.x + c * cx - s * cy;
  y_ = pose.y + s * cx + c * cy;
  theta_ = pose.theta;
  state_.pose = pose;
}

void Plant::set_supply_voltage(double voltage) {
  VERISIM_ASSERT(is_not_negative(voltage));
  parameters_.supply.voltage = voltage;
}

void Plant::set_blocked(std::size_t wheel, bool blocked) {
  VERISIM_ASSERT(wheel < kWheels);
  blocked_[wheel] = blocked;
}

void Plant::set_encoder_fault(std::size_t wheel, EncoderFault fault) {
  VERISIM_ASSERT(wheel < kWheels);
  encoder_[wheel].set_fault(fault);
}

/// Moments about the centre of mass vanish: the base stays level.
PerWheel Plant::loads(const Reaction& reaction) {
  const auto [cx, cy] = parameters_.body.centre_of_mass;
  const double height = parameters_.body.height;
  const Vector3d arm = reaction.point - Vector3d(cx, cy, height);
  const Vector3d moment = arm.cross(reaction.force) + reaction.torque;
  const double W = parameters_.body.mass * parameters_.gravity - reaction.force.z();
  const double S_x = cx * W - height * base_.floor_force().x() + moment.y();
  const double S_y = cy * W - height * base_.floor_force().y() - moment.x();
  PerWheel N;
  double carried = 0;
  for (std::size_t i = 0; i < kWheels; ++i) {
    N[i] = std::max(W / 4 + per_moment_[i][0] * S_x + per_moment_[i][1] * S_y, 0.0);
    carried += N[i];
  }
  if (carried > W * (1 + 1e-12)) {
    ++tipping_;
    const double scale = W > 0 ? W / carried : 0;
    for (double& n : N) n *= scale;
  }
  return N;
}

void Plant::substep(const PerWheel& duty, const Reaction& reaction, std::uint32_t cycle) {
  const double voltage = parameters_.supply.voltage - parameters_.supply.resistance * supply_current_;
  std::array<MotorDrive, kWheels> drive;
  for (std::size_t i = 0; i < kWheels; ++i) {
    drive[i].torque = winding_[i].begin(duty[i] * voltage, base_.wheels()[i].motor_speed);
    drive[i].blocked = blocked_[i];
  }
  state_.load = loads(reaction);
  const auto [cx, cy] = parameters_.body.centre_of_mass;
  const Vector3d& f = reaction.force;
  const Vector3d wrench(f.x(), f.y(),
                        (reaction.point.x() - cx) * f.y() - (reaction.point.y() - cy) * f.x() + reaction.torque.z());
  PerWheel before;
  for (std::size_t i = 0; i < kWheels; ++i) before[i] = base_.wheels()[i].motor_speed;
  base_.step(drive, state_.load, wrench);
  const auto cycles = kCyclesPerMillisecond / static_cast<std::uint32_t>(parameters_.substeps);
  double supply_current = 0;
  for (std::size_t i = 0; i < kWheels; ++i) {
    const double speed = (before[i] + base_.wheels()[i].motor_speed) / 2;
    const WindingStep done = winding_[i].end(speed);
    supply_current += duty[i] * done.current;
    book_.windings += h_ * parameters_.motor.resistance * done.current_square;
    book_.bridges += h_ * (parameters_.bridge.drop * std::abs(done.current) +
                           parameters_.bridge.drop_per_ampere * done.current_square) +
                     winding_[i].lost_at_reversal();
    encoder_[i].turn(h_ * speed, cycle, cycles, edges_);
  }
  book_.source += h_ * parameters_.supply.voltage * supply_current;
  book_.battery += h_ * parameters_.supply.resistance * supply_current_ * supply_current;
  supply_current_ = supply_current;
  state_.supply_voltage = voltage;
}

/// The step's way, along the coordinates in which its velocities are; then those turn. (1 - t^2, 2 t) / (1 + t^2) is a
/// rotation to rounding, whatever t; its angle differs from h omega by (h omega)^3 / 12.
void Plant::move(const Vector3d& before, double& cosine, double& sine) {
  const Vector3d way = h_ / 2 * (before + base_.velocity());
  x_ += cosine * way.x() - sine * way.y();
  y_ += sine * way.x() + cosine * way.y();
  theta_ += way.z();
  const double t = way.z() / 2, scale = 1 / (1 + t * t);
  const double c = (1 - t * t) * scale, s = 2 * t * scale;
  base_.turn_coordinates(c, s);
  const double old = cosine;
  cosine = c * old - s * sine;
  sine = s * old + c * sine;
}

std::span<const Edge> Plant::advance(const std::array<std::int16_t, kWheels>& duty, const Reaction& reaction) {
  VERISIM_ASSERT(is_finite(reaction.force));
  VERISIM_ASSERT(is_finite(reaction.torque));
  VERISIM_ASSERT(is_finite(reaction.point));
  PerWheel fraction{};
  for (std::size_t i = 0; i < kWheels; ++i) {
    VERISIM_ASSERT(std::abs(duty[i]) <= kDutyMax);
    fraction[i] = is_supplied_ ? static_cast<double>(duty[i]) / kDutyMax : 0;
  }
  edges_.clear();
  double cosine = pinned::cos(theta_), sine = pinned::sin(theta_);
  const auto substeps = static_cast<std::uint32_t>(parameters_.substeps);
  for (std::uint32_t k = 0; k < substeps; ++k) {
    const Vector3d before = base_.velocity();
    substep(fraction, reaction, k * (kCyclesPerMillisecond / substeps));
    move(before, cosine, sine);
  }
  publish();
  return edges_.all();
}

void Plant::publish() {
  const auto [cx, cy] = parameters_.body.centre_of_mass;
  const double c = pinned::cos(theta_), s = pinned::sin(theta_);
  const Vector3d& u = base_.velocity();
  state_.pose = {x_ - (c * cx - s * cy), y_ - (s * cx + c * cy), theta_};
  state_.twist = {u.x() + u.z() * cy, u.y() - u.z() * cx, u.z()};
  for (std::size_t i = 0; i < kWheels; ++i) {
    const WheelState& wheel = base_.wheels()[i];
    state_.wheel_speed[i] = wheel.wheel_speed;
    state_.motor_speed[i] = wheel.motor_speed;
    state_.slip[i] = base_.forces()[i].slip;
    state_.current[i] = winding_[i].current();
    state_.counts[i] = encoder_[i].counts();
  }
}

double Plant::coil_energy() const {
  double squares = 0;
  for (const Winding& winding : winding_) squares += winding.current() * winding.current();
  return parameters_.motor.inductance / 2 * squares;
}

}  // namespace verisim::robot
