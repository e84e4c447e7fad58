// The head pose from the images of two LEDs, in closed form and exact for a pinhole.
//
// Two points give four numbers; a pose has six. The two that cannot be known, yaw and pitch, are assumed zero: the head
// is R_LH = Rz(roll), level in L but for its roll. Yaw then looks like distance (dissertation section 2.9); the
// covariance of whoever uses this has to say so.
#pragma once

#include "engine/base/pose.hpp"
#include "engine/wii/thresholds.hpp"

namespace verisim::wii {

/// Two LEDs in head coordinates H [m].
struct LedPair {
  Vector3d p0_H = {0.075, 0, 0};
  Vector3d p1_H = {-0.075, 0, 0};
};

struct TwoPointPose {
  Vector3d p_L = Vector3d::Zero();  ///< origin of H [m]
  double cos_roll = 1;              ///< R_LH = Rz(roll)
  double sin_roll = 0;
  double depth = 0;  ///< of the first LED along the lens axis [m]
  bool found = false;
};

/// Solves Z0 q0 - Z1 q1 = Rz(roll) (p0_H - p1_H) with q = C_LR ray for both depths and the roll. Not found when the two
/// rays are parallel, when the solution lies behind the lens, or when a ray rises so steeply (more than about 78
/// degrees) that "level" says nothing about depth. About 40 flops and two square roots.
/// @param forward_min  Thresholds::forward_min
/// @pre rays have z = 1 (Pinhole::ray); the LEDs differ in x or y
[[nodiscard]] TwoPointPose solve_two_points(const LedPair& leds, const Vector3d& ray0_R, const Vector3d& ray1_R,
                                            const Matrix3d& C_LR, double forward_min = Thresholds().forward_min);

/// The unit quaternion of Rz(angle), without trigonometry. @pre the arguments are a cosine and a sine, to rounding
[[nodiscard]] Quaterniond rotation_about_z(double cos_angle, double sin_angle);

}  // namespace verisim::wii
