// How far a two-LED estimate can be off, to first order in pixels and tilt, to second in yaw.
#pragma once

#include "engine/wii/tracker.hpp"

namespace verisim::wii {

/// Covariance of (position, rotation vector) in L of a head at `p_L`, its LEDs `spacing` [m] apart along Rz(roll) x.
/// With s = spacing / Z the measured spacing in the image, Z the depth and sigma the pixel noise over the focal length:
///   across the ray  Z^2 sigma^2 / 2,   along it  dZ = Z^2 / spacing * sqrt(2) sigma,
///   yaw psi, unseen: dZ = Z (k psi - psi^2 / 2) with k the sine of the head's bearing along the LED line,
///   tilt of the accelerometer: turns everything about the pinhole.
/// @pre spacing > 0
[[nodiscard]] Matrix6d two_led_covariance(const TrackerSettings& settings, const Pinhole& pinhole, double spacing,
                                          const Vector3d& p_L, double cos_roll, double sin_roll);

}  // namespace verisim::wii
