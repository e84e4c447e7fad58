// The aim of an operator that follows a path in device coordinates: along its legs at their speeds, waiting while the
// hand is held up, and back when patience ends.
#pragma once

#include "engine/base/random.hpp"
#include "engine/device/hand.hpp"

namespace verisim {

class WaypointPath {
 public:
  /// @pre hand.path is not empty; hand outlives this
  WaypointPath(const HandDescription& hand, double reaction);

  /// Where the hand starts: the first waypoint, misjudged.
  [[nodiscard]] Pose start() const;
  /// Advances the target along the path; waits while the hand is held up, and withdraws when patience ends.
  /// @param x  m, where the hand is
  void walk(const Vector3d& x, double dt);
  /// The target, misjudged, with the tremor.
  [[nodiscard]] Pose aim(const Vector3d& tremor, const Vector3d& angular_tremor) const;
  /// s, of all legs and dwells
  [[nodiscard]] double duration() const;
  /// m, of the target from its first place
  [[nodiscard]] double farthest() const;

 private:
  void notice(bool held_up, double dt);
  void retry();
  Vector3d draw_signed();
  [[nodiscard]] double fraction_walked() const;
  [[nodiscard]] Pose target() const;

  const HandDescription& hand_;
  double reaction_;
  RandomStream retries_;
  std::uint64_t tries_ = 0;
  Vector3d error_, angular_error_;
  std::size_t from_ = 0, goal_ = 0;  ///< the leg that is walked
  double along_ = 0, dwelling_ = 0, waited_ = 0, noticing_ = 0;
  bool withdrawing_ = false, is_held_up_ = false;
};

}  // namespace verisim
