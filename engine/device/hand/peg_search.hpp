// How a hand looks for a hole that it misjudged, while it presses the peg lightly against the surface: offsets of the
// peg across the axis, and turns of it, as functions of time. Virtual world.
//
//   spiral  the path of an Archimedean spiral, r = pitch theta / 2 pi, at constant speed. No place in its radius is
//           further than pitch / 2 from the path: a hole is met if the clearance on the radius is that or more.
//   tilt    the peg is tipped by `tilt`, so that one edge of its tip leads, pressed, slid in the direction of that edge
//           until the edge finds the hole's wall, and erected; then in another direction. An edge finds the hole from
//           further away than a face.
#pragma once

#include "engine/device/hand.hpp"
#include "engine/device/hand/minimum_jerk.hpp"

namespace verisim {

class PegSearch {
 public:
  struct Offset {
    Vector3d place = Vector3d::Zero();  ///< m
    Vector3d turn = Vector3d::Zero();   ///< rad, rotation vector
  };

  /// Begins to search around where it is. @pre axis is a unit vector; the goal's strategy is not straight
  void begin(double t, const HandGoal& goal, const Vector3d& axis);
  /// The hole is found: the peg is erected and goes on where it was at time `was`. @pre it searches
  void keep(double t, double was);
  /// Back to where it would be without a search.
  void clear(double t);
  [[nodiscard]] bool searches() const { return searches_; }
  /// It has been everywhere.
  [[nodiscard]] bool is_exhausted(double t) const;
  /// Would the peg go deeper now if the hole were there? A tilted one does so without.
  [[nodiscard]] bool can_find(double t) const;
  [[nodiscard]] Offset at(double t) const;

 private:
  [[nodiscard]] Offset spiral(double t) const;
  [[nodiscard]] Offset tilted(double t) const;
  void settle(double t, const Offset& now, const Vector3d& place);

  HandGoal goal_;
  bool searches_ = false;
  double start_ = 0;
  Vector3d axis_ = Vector3d::UnitZ(), u_ = Vector3d::UnitX(), v_ = Vector3d::UnitY();
  Vector3d center_ = Vector3d::Zero();
  MinimumJerk place_{Vector3d::Zero()}, turn_{Vector3d::Zero()};  ///< while it does not search
};

}  // namespace verisim
