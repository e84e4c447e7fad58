#include "engine/robot/pilot.hpp"

namespace verisim::robot {

Pilot::Pilot(const PilotSettings& settings) : server_(settings.server), drive_(settings.drive) {
  if (settings.walls) walls_.emplace(*settings.walls);
}

void Pilot::start() {
  server_.start();
  drive_.restart();
  if (walls_) walls_->forget();
}

std::span<const std::uint8_t> Pilot::advance(const std::array<double, 2>& p_D,
                                             const std::optional<std::array<double, 2>>& head_F,
                                             const TrackedBase& tracked) {
  error_R_ = drive_.error_R(p_D);
  const PlanarTwist wanted = server_.wanted(error_R_[0], error_R_[1]);
  const PlanarTwist driven = server_.within_reach(drive_.advance(wanted, tracked, p_D, head_F));
  const PlanarTwist limited = walls_ ? walls_->limit(driven, tracked) : driven;
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
