#include "engine/robot/pilot.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/error.hpp"
#include "engine/robot/clock.hpp"

namespace verisim::robot {

Pilot::Pilot(const PilotSettings& settings)
    : step_(settings.acceleration * kMillisecond),
      angular_step_(settings.angular_acceleration * kMillisecond),
      server_(settings.server),
      drive_(settings.drive) {
  if (!(settings.acceleration > 0) || !(settings.angular_acceleration > 0))
    fail(ErrorKind::input, "pilot: accelerations are {} m/s^2 and {} rad/s^2 but must be above 0",
         settings.acceleration, settings.angular_acceleration);
  if (settings.walls) walls_.emplace(*settings.walls);
}

void Pilot::start() {
  server_.start();
  drive_.restart();
  if (walls_) walls_->forget();
  ramp_ = {};
}

PlanarTwist Pilot::ramped(const PlanarTwist& to) const {
  const double dx = to.vx - ramp_.vx, dy = to.vy - ramp_.vy, turn = to.omega - ramp_.omega;
  const double size = std::sqrt(dx * dx + dy * dy), scale = size > step_ ? step_ / size : 1;
  return {ramp_.vx + scale * dx, ramp_.vy + scale * dy, ramp_.omega + std::clamp(turn, -angular_step_, angular_step_)};
}

std::span<const std::uint8_t> Pilot::advance(const std::array<double, 2>& p_D,
                                             const std::optional<std::array<double, 2>>& head_F,
                                             const TrackedBase& tracked) {
  error_R_ = drive_.error_R(p_D);
  const PlanarTwist wanted = server_.wanted(error_R_[0], error_R_[1]);
  const PlanarTwist driven = ramped(server_.within_reach(drive_.advance(wanted, tracked, p_D, head_F)));
  const PlanarTwist limited = walls_ ? walls_->limit(driven, tracked) : driven;
  ramp_ = limited;
  server_.command(limited);
  drive_.in_force(server_.reported_command(), tracked);
  return server_.advance();
}

std::array<double, 2> Pilot::limit_force_R() const {
  if (!walls_ || !server_.is_running()) return {0, 0};
  return walls_->limit_force(error_R_);
}

void Pilot::report(RobotNotes& notes) {
  server_.report(notes);
  drive_.report(notes);
  if (walls_) walls_->report(notes);
}

}  // namespace verisim::robot
