// How far a two-LED estimate can be off, to first order in pixels, to second in yaw and pitch.
#pragma once

#include "engine/wii/tracker.hpp"

namespace verisim::wii {

/// Covariance of (position, rotation vector) in L of a head at `p_L`, turned by Rz(roll), as the first two LEDs of the
/// settings give it (two_point.hpp). What tilt of the accelerometer adds is add_tilt (gravity.hpp).
///
/// LED i is seen on its ray, whatever its depth: a displacement d_i of it looks like one of position and roll with
///   P_i (dp + droll z x a_i) = P_i d_i,   P_i = [1 0 -x_i/z_i; 0 1 -y_i/z_i],   a_i = Rz(roll) p_Hi:
/// four equations for four unknowns. d_i is the pixel noise times the depth, or what a small yaw or pitch, taken for
/// zero, moves the LED by.
/// Not finite where both LEDs lie on one ray. LEDs nearer than 5 cm count as 5 cm away. @pre p_L is finite
[[nodiscard]] Matrix6d two_led_covariance(const TrackerSettings& settings, const Pinhole& pinhole, const Vector3d& p_L,
                                          double cos_roll, double sin_roll);

/// What a yaw psi and a pitch theta that two LEDs do not show do to second order (two_led_covariance has it): the head
/// seems farther by psi^2 / 2 of its distance, and rolled by psi theta / 2, for turns do not commute.
void add_second_order(Matrix6d& covariance, const Vector3d& p_L, double yaw_sigma, double pitch_sigma);

}  // namespace verisim::wii
