// The mechanics of an operator's arm: a mass and an inertia that a spring pulls towards the aim and a damper slows,
// with the felt wrench and the handle's load. Device coordinates. Backward Euler: stable for any stiffness and mass.
#pragma once

#include "engine/device/hand.hpp"

namespace verisim {

class Arm {
 public:
  /// @param reach  m, the furthest it gets from its start, whatever pushes
  Arm(const HandDescription& hand, const Pose& start, double reach, double force_max)
      : hand_(hand),
        x_(start.position),
        q_(start.rotation),
        start_(start.position),
        reach_(reach),
        force_max_(force_max) {}

  [[nodiscard]] Pose pose() const { return {x_, q_}; }
  [[nodiscard]] const Vector3d& position() const { return x_; }
  void carry(const HandleLoad& load) { load_ = load; }
  /// One step towards `aim` under the felt wrench. @pre dt is finite and above 0
  void pull(const Pose& aim, const Wrench& felt, double dt);

 private:
  void keep_within_reach();

  const HandDescription& hand_;
  Vector3d x_, v_ = Vector3d::Zero(), w_ = Vector3d::Zero();
  Quaterniond q_;
  Vector3d start_;
  double reach_, force_max_;
  HandleLoad load_;
};

}  // namespace verisim
