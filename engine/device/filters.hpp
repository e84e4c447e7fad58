// Filters that place a device elsewhere: translated, rotated, scaled. Each wraps any device, and is one.
//
// A filter is lossless if the power f.v + tau.omega that goes in comes out: translate and rotate are. A scale is not
// meant to be: it makes motions larger by s and forces smaller by s, as SPARTA does, so that the hand is given 1/s^2 of
// the power of its linear motion.
#pragma once

#include <memory>

#include "engine/device/device.hpp"

namespace verisim {

/// Scales positions and velocities of `inner` by `scale` about the origin and forces down by it (section 4.3.1);
/// rotations and torques stay. Error(input) unless `scale` is finite and above 0. @pre inner is not null
[[nodiscard]] std::shared_ptr<Device> make_scale(std::shared_ptr<Device> inner, double scale);
/// Moves handle positions by `translation`. Error(input) unless it is finite. @pre inner is not null
[[nodiscard]] std::shared_ptr<Device> make_translate(std::shared_ptr<Device> inner, const Vector3d& translation);
/// Turns the handle about the origin by `rotation`. Error(input) unless it is a unit quaternion. @pre inner is not null
[[nodiscard]] std::shared_ptr<Device> make_rotate(std::shared_ptr<Device> inner, const Quaterniond& rotation);

}  // namespace verisim
