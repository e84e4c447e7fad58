// Does the base move as it is told? Compares the motion that the robot says it was commanded (the setpoints that it
// reports: a line that is cut or a watchdog that stopped it mislead nobody) with the motion that the tracker saw, each
// axis of the robot for itself. Without reports nothing is compared. A tracker whose axes are swapped, or whose yaw
// runs the other way, shows motion that has nothing to do with the command, or opposes it: then heading and walls would
// steer wrongly, and the robot has to stop.
//
// A stride is the motion between two reports at least 0.1 s apart. Over strides, older ones forgotten with a time
// constant of 2 s, for each axis i of x, y and 0.3 m times yaw:
//   followed_i = sum(commanded_i moved_i) / sum(commanded_i^2)        1: as told   0: not at all   below: the other way
// The base is judged along an axis once sum(commanded_i^2) is above (0.05 m)^2, a third of a second at 0.3 m/s.
//   wrong:   followed < 0.3 (yaw: < -0.5, because the user's torque turns the base too)
// A stride with |moved|^2 < 0.1 |commanded|^2 is left out of these sums. Where such strides outweigh the others:
//   idle:    the base does not follow at all. Motor power is off, or a wheel is stuck
// A stride of more than 1.5 m/s is left out, too: no base makes it, but the tracker's axes when they are set up anew.
// A stride that turns by more than 1.5 times what was commanded, and 0.02 rad, tells nothing about yaw: the base slips.
// A motion along x = y is the same with swapped axes: that is not found, and does no harm while it lasts.
// Robot coordinates R by the tracked yaw. No allocation after construction; a few ns in a millisecond without a report.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/robot/base_tracker.hpp"

namespace verisim::robot {

class AxesCheck {
 public:
  /// `lag`: s from a command until the base has taken it up; the tracker's latency is known from each report's age.
  /// In [0, 1].
  explicit AxesCheck(double lag);

  /// Takes one millisecond: the command that the robot has in force [R], if it is known, and what the tracker says.
  /// @pre command is finite
  void advance(const std::optional<PlanarTwist>& command, const TrackedBase& tracked);
  [[nodiscard]] bool is_wrong() const { return is_wrong_; }  ///< stays so until forget()
  [[nodiscard]] bool is_idle() const { return is_idle_; }
  /// Of x, y and yaw; NaN where too little was commanded to tell.
  [[nodiscard]] std::array<double, 3> followed() const;
  void forget();

 private:
  void take_stride(const TrackedBase& tracked, std::uint64_t taken);
  [[nodiscard]] const PlanarPose& commanded_at(std::uint64_t ms) const;

  std::uint64_t lag_ms_, now_ = 0, last_taken_ = 0, unknown_until_ = 0;
  std::vector<PlanarPose> commanded_;  ///< ring: the sum of what was commanded up to each millisecond, in R
  PlanarPose last_;                    ///< where the last stride ended
  bool has_last_ = false, is_wrong_ = false, is_idle_ = false;
  std::array<double, 3> cross_{}, commanded_squares_{};
  double idle_squares_ = 0;
};

}  // namespace verisim::robot
