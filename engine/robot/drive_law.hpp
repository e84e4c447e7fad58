// What moves the base: the handle's error and the tracker's word become the velocity that the robot is asked for.
//
// The law of dissertation section 5.3: the base's velocity is proportional to the error between the end effector and a
// neutral position, both in the coordinates of the haptic device. The gain itself is the robot server's. Beyond it: a
// rotation command from the tracked yaw (heading.hpp), and what to do when the tracker is gone or cannot be right.
//
// Coordinates. D: the device's base seen from above, x as the device's x, y as its -z (as floor coordinates F lie in a
// world whose y is up). R: the robot's, x forward, y left; D stands on it turned by mount_yaw, both origins above one
// another. SI. No allocation, no wall clock.
#pragma once

#include <array>
#include <optional>

#include "engine/robot/axes_check.hpp"
#include "engine/robot/base_tracker.hpp"
#include "engine/robot/heading.hpp"
#include "engine/robot/notes.hpp"

namespace verisim::robot {

struct DriveLawSettings {
  std::array<double, 2> neutral_D{0, -0.55};  ///< m; published for the Virtuose: x 0, z 0.55
  double mount_yaw = 0;                       ///< rad, of D in R
  HeadingSettings heading;                    ///< its lost_after also limits the speed
  double lost_speed = 0.1;  ///< m/s: while the tracker is gone for longer than that. Infinite: no limit
  double lag = 0.060;       ///< s: see AxesCheck
};

class DriveLaw {
 public:
  /// Error(input) for settings out of range.
  explicit DriveLaw(const DriveLawSettings& settings);

  /// Error of a handle at p_D [m], in R. May be no number, if the handle is none: the robot server refuses it.
  [[nodiscard]] std::array<double, 2> error_R(const std::array<double, 2>& p_D) const;
  /// Takes one millisecond. `wanted`: gain x error. `head_F`: where the person's head is, if it is tracked; `p_D` of
  /// the handle gives the line of sight with it. @pre wanted is finite
  [[nodiscard]] PlanarTwist advance(const PlanarTwist& wanted, const TrackedBase& tracked,
                                    const std::array<double, 2>& p_D,
                                    const std::optional<std::array<double, 2>>& head_F);
  /// What the robot has in force in this millisecond, as it reports it: what its motion is held against
  /// (axes_check.hpp).
  void in_force(const std::optional<PlanarTwist>& command, const TrackedBase& tracked) {
    axes_.advance(command, tracked);
  }

  /// The tracked motion was not the commanded one: it stands until restart(), because standing proves nothing.
  [[nodiscard]] bool is_stopped() const { return axes_.is_wrong(); }
  void restart() { axes_.forget(); }
  [[nodiscard]] const Heading& heading() const { return heading_; }
  [[nodiscard]] const AxesCheck& axes() const { return axes_; }
  void report(RobotNotes& notes);

 private:
  [[nodiscard]] std::array<double, 2> turned_to_R(const std::array<double, 2>& p_D) const;

  DriveLawSettings settings_;
  double mount_cos_, mount_sin_;
  Heading heading_;
  AxesCheck axes_;
  std::uint64_t now_ = 0;
  Spell lost_{"tracker", "is gone: no heading control, speed is limited", "is back: heading control, no speed limit"};
  Spell wrong_{"tracker", "shows another motion than the commanded one (swapped axes?): the robot stops",
               "is trusted again"};
  Spell idle_{"robot", "does not follow its commands (motor power, a stuck wheel?)", "follows its commands again"};
};

}  // namespace verisim::robot
