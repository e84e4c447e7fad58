// What carries a haptic device through a room: a mobile robot (dissertation chapter 5). Devices know it by this alone.
//
// World coordinates W: y up, the floor is the plane of x and z. Base coordinates B are the device's own: y up, origin
// where the device is bolted to what carries it. SI units.
#pragma once

#include "engine/base/pose.hpp"

namespace verisim {

class MovingBase {
 public:
  MovingBase() = default;
  virtual ~MovingBase() = default;
  MovingBase(const MovingBase&) = delete;
  MovingBase& operator=(const MovingBase&) = delete;

  /// X_WB, where it stands at the end of the last frame. Only what is really mounted on it may ask.
  [[nodiscard]] virtual const Pose& pose() const = 0;
  /// X_WB as the room's tracker said it last; where it began, before the first report.
  [[nodiscard]] virtual const Pose& tracked_pose() const = 0;
  /// What moves the base, in the frame to come: how far the handle is from the device's neutral place, along x and z of
  /// B [m].
  virtual void follow(double error_x, double error_z) = 0;
  /// What the hand shall feel of the room's limits, beside what it feels already: force at the handle, in B [N].
  [[nodiscard]] virtual const Vector3d& limit() const = 0;
  /// What stands on the base pushes it in the frame to come: force and torque about B's origin, in B [N, N m]. Several
  /// add up.
  virtual void load(const Wrench& wrench) = 0;
};

}  // namespace verisim
