// The bubble technique (dissertation chapter 4; Dominjon et al. 2005): inside a sphere around the middle of the
// device's workspace the handle is controlled by position, outside of it by rate: the bubble, and with it the
// workspace, moves through the world, and a spring pulls the hand back.
//
//   x = D - R     how far outside; D is the handle's distance from the centre, in the wrapped device's coordinates
//   F = -k x      towards the centre, on the hand, besides what the scene renders
//   V = law(x)    of the bubble, away from the centre
//
// Pose, velocity and force are continuous at the surface. A bubble moves by explicit steps: with the velocity of this
// frame's handle, from the next frame on, so the handle's velocity has the motion that it really made.
#pragma once

#include <memory>

#include "engine/device/bubble_law.hpp"
#include "engine/device/device.hpp"
#include "engine/device/navigator.hpp"

namespace verisim {

struct BubbleDescription {
  double radius = 0.1;    ///< m, R
  double stiffness = 50;  ///< N/m, k
  BubbleLaw law;
  Vector3d center = Vector3d::Zero();  ///< m, in the wrapped device's coordinates
  Vector3d moves = Vector3d::Ones();   ///< 1: the bubble moves along this axis of the world; 0: it does not
  bool elastic = true;                 ///< false: no spring
  /// The bubble stands still while the body that the device holds touches something, by the short-term maximum of the
  /// collision count (collision_start.hpp): section 4.3.2 asks when it should move again; here after `clear` seconds.
  bool stops_in_collision = false;
  double clear = 0.1;  ///< s
};

/// A bubble around `inner`. It records bubble_center, bubble_velocity and outside, and says when the handle leaves the
/// bubble and comes back, and when a collision stops it. Error(input) unless radius, stiffness, scale, peak, taper and
/// clear are finite and above 0 (taper below 1), the centre is finite and within the device's workspace, and each of
/// `moves` is 0 or 1. @pre inner is not null. About 30 ns a frame.
/// @param navigator  what the bubble moves; null: its own
[[nodiscard]] std::shared_ptr<Device> make_bubble(std::shared_ptr<Device> inner, const BubbleDescription& description,
                                                  std::shared_ptr<Navigator> navigator = nullptr);

}  // namespace verisim
