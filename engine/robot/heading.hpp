// Closed-loop heading of the base (dissertation section 5.5, future work: "a rotational control scheme to keep the
// robot aligned with the axes"; reaction torques at the floor turn it, and nothing turned it back). A rotation command
// comes of the tracked yaw; and, as an option, the wanted heading of where the person's head is, so that the device is
// not in the line of sight ("the haptic device occludes the user's view"). Floor coordinates F, angles in rad, left is
// positive.
#pragma once

#include <cstdint>
#include <optional>

#include "engine/robot/base_tracker.hpp"

namespace verisim::robot {

/// The angle that differs from `angle` by full turns, in (-pi, pi]. @pre finite
[[nodiscard]] double wrapped(double angle);

struct HeadingSettings {
  double p = 2;            ///< 1/s: rotation per error. 0: no heading control
  double i = 0;            ///< 1/s^2: on the error's integral, which stands still while the command is at its limit
  double omega_max = 0.5;  ///< rad/s. Above 0
  double desired = 0;      ///< rad: along the room's axes
  double clearance = 0;  ///< rad, at most pi / 2: the least angle of the device to the line of sight. 0: no such option
  double lost_after = 0.25;  ///< s: tracked yaw that is older turns nothing. p x lost_after below 1
};

/// The heading nearest to `now` at which the line from the base's middle to the neutral point has at least `clearance`
/// to the line of sight, whichever end of it looks at the head. `sight`: heading from head to handle; `neutral`:
/// direction from the base's middle to the neutral point, in R. Exactly in the line of sight it turns left.
[[nodiscard]] double heading_clear_of_sight(double now, double sight, double neutral, double clearance);

class Heading {
 public:
  /// Error(input) for settings out of the ranges above. `neutral`: see heading_clear_of_sight.
  Heading(const HeadingSettings& settings, double neutral);

  /// Takes one millisecond; the rotation command [rad/s]. Between two reports of the tracker the last command holds:
  /// with p x lost_after < 1 it cannot turn past what was measured. Without a report for lost_after it is 0 and the
  /// integral stands still. `sight`: heading from head to handle, if a head is tracked; without one the wanted heading
  /// stays.
  [[nodiscard]] double advance(const TrackedBase& tracked, const std::optional<double>& sight);
  [[nodiscard]] double desired() const { return desired_; }
  [[nodiscard]] bool is_on() const { return is_on_; }

 private:
  HeadingSettings settings_;
  double neutral_, desired_, integral_ = 0, command_ = 0;
  std::uint64_t since_ms_ = 0;  ///< since the last report
  bool is_on_ = false;
};

}  // namespace verisim::robot
