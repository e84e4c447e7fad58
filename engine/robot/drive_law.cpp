#include "engine/robot/drive_law.hpp"

#include <cmath>

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim::robot {

namespace {

const DriveLawSettings& checked(const DriveLawSettings& s) {
  if (!std::isfinite(s.neutral_D[0]) || !std::isfinite(s.neutral_D[1]))
    fail(ErrorKind::input, "drive law: neutral point ({}, {}) is not finite", s.neutral_D[0], s.neutral_D[1]);
  if (!std::isfinite(s.mount_yaw)) fail(ErrorKind::input, "drive law: mount_yaw is {} but must be finite", s.mount_yaw);
  if (!(s.lost_speed >= 0))
    fail(ErrorKind::input, "drive law: lost_speed is {} m/s but must be 0 or above", s.lost_speed);
  return s;
}

/// Heading of the neutral point from the base's middle, in R; forward, where the two are one.
double neutral_heading(const DriveLawSettings& s) {
  return pinned::atan2(s.neutral_D[1], s.neutral_D[0]) + s.mount_yaw;
}

}  // namespace

DriveLaw::DriveLaw(const DriveLawSettings& settings)
    : settings_(checked(settings)),
      mount_cos_(pinned::cos(settings.mount_yaw)),
      mount_sin_(pinned::sin(settings.mount_yaw)),
      heading_(settings.heading, neutral_heading(settings)),
      axes_(settings.lag) {}

std::array<double, 2> DriveLaw::turned_to_R(const std::array<double, 2>& p_D) const {
  return {mount_cos_ * p_D[0] - mount_sin_ * p_D[1], mount_sin_ * p_D[0] + mount_cos_ * p_D[1]};
}

std::array<double, 2> DriveLaw::error_R(const std::array<double, 2>& p_D) const {
  return turned_to_R({p_D[0] - settings_.neutral_D[0], p_D[1] - settings_.neutral_D[1]});
}

PlanarTwist DriveLaw::advance(const PlanarTwist& wanted, const TrackedBase& tracked, const std::array<double, 2>& p_D,
                              const std::optional<std::array<double, 2>>& head_F) {
  VERISIM_ASSERT(std::isfinite(wanted.vx));
  VERISIM_ASSERT(std::isfinite(wanted.vy));
  std::optional<double> sight;
  if (head_F) {
    const std::array<double, 2> p_R = turned_to_R(p_D);
    const double c = pinned::cos(tracked.pose.theta), s = pinned::sin(tracked.pose.theta);
    const double x = tracked.pose.x + c * p_R[0] - s * p_R[1] - (*head_F)[0];
    const double y = tracked.pose.y + s * p_R[0] + c * p_R[1] - (*head_F)[1];
    if (std::isfinite(x) && std::isfinite(y) && x * x + y * y > 0) sight = pinned::atan2(y, x);
  }
  const double omega = heading_.advance(tracked, sight);
  const bool is_lost = tracked.age >= settings_.heading.lost_after;
  const bool had_time = static_cast<double>(now_) > 1000 * settings_.heading.lost_after;  // for a first report
  lost_.see(is_lost && had_time, now_);
  wrong_.see(axes_.is_wrong(), now_);
  idle_.see(axes_.is_idle(), now_);
  ++now_;
  if (axes_.is_wrong()) return {};
  PlanarTwist command{wanted.vx, wanted.vy, omega};
  const double speed = std::sqrt(wanted.vx * wanted.vx + wanted.vy * wanted.vy);
  if (is_lost && speed > settings_.lost_speed) {
    command.vx *= settings_.lost_speed / speed;
    command.vy *= settings_.lost_speed / speed;
  }
  return command;
}

void DriveLaw::report(RobotNotes& notes) {
  for (Spell* spell : {&lost_, &wrong_, &idle_}) spell->report(notes);
}

}  // namespace verisim::robot
