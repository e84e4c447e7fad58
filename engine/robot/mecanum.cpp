#include "engine/robot/mecanum.hpp"

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim::robot {
namespace {

constexpr double kHalfRoot = 0.70710678118654752440;  // sin and cos of 45 degrees

}  // namespace

PerWheel wheel_speeds(const MecanumGeometry& geometry, const PlanarTwist& twist) {
  VERISIM_ASSERT(is_positive(geometry.wheel_radius));
  const double r = geometry.wheel_radius;
  const double turning = (geometry.half_base + geometry.half_track) * twist.omega;
  return {(twist.vx - twist.vy - turning) / r, (twist.vx + twist.vy + turning) / r, (twist.vx + twist.vy - turning) / r,
          (twist.vx - twist.vy + turning) / r};
}

PlanarTwist twist_of(const MecanumGeometry& geometry, const PerWheel& speeds) {
  VERISIM_ASSERT(is_positive(geometry.half_base + geometry.half_track));
  const auto [FL, FR, RL, RR] = speeds;
  const double quarter = geometry.wheel_radius / 4;
  // The columns of the inverse kinematics are orthogonal: least squares needs no matrix.
  return {quarter * (FL + FR + RL + RR), quarter * (-FL + FR + RL - RR),
          quarter * (-FL + FR - RL + RR) / (geometry.half_base + geometry.half_track)};
}

double slip_residual(const PerWheel& speeds) {
  return speeds[kFrontLeft] + speeds[kFrontRight] - speeds[kRearLeft] - speeds[kRearRight];
}

WheelPlace wheel_place(const MecanumGeometry& geometry, std::size_t wheel) {
  VERISIM_ASSERT(wheel < kWheels);
  const bool front = wheel == kFrontLeft || wheel == kFrontRight;
  const bool left = wheel == kFrontLeft || wheel == kRearLeft;
  return {{front ? geometry.half_base : -geometry.half_base, left ? geometry.half_track : -geometry.half_track},
          {kHalfRoot, front == left ? -kHalfRoot : kHalfRoot}};
}

}  // namespace verisim::robot
