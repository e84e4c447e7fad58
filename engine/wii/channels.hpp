// What a Wii Remote sends, as VRPN's 16 analog channels, and how trackers read them.
//
// Channel 0 battery; 1 to 3 accelerometer [g] in its own axes (x: remote's left, y: expansion port, z: out of the
// buttons); then four slots of u, v [pixel, v upward] and size (0 to 15), -1 where a slot sees nothing.
// Remote coordinates R: +z out of the lens, +y out of the buttons, +x the remote's left; origin at the pinhole.
// Source: reference/wii/README.md, ORACLES section 2 "Wii axes".
#pragma once

#include <array>
#include <span>

#include "engine/base/pose.hpp"

namespace verisim::wii {

inline constexpr int kChannels = 16;
inline constexpr int kSlots = 4;
inline constexpr int kChannelsMin =
    15;  ///< the paper's "15 analog channels": slot 3 then lacks its size, and is unused
using Channels = std::array<double, kChannels>;

inline constexpr double kWidth = 1024;  ///< pixel
inline constexpr double kHeight = 768;  ///< pixel

/// One bright spot of the image.
struct Blob {
  double u = 0;     ///< pixel, 0 … 1023, grows with +x
  double v = 0;     ///< pixel, 0 … 767, grows with +y (upward)
  double size = 0;  ///< 0 … 15
};

/// The plausible part of one report.
struct Reading {
  std::array<Blob, kSlots> blobs;  ///< the first `blob_count` are set, in slot order, no two at one place
  int blob_count = 0;
  Vector3d force_R = Vector3d::Zero();  ///< specific force [g]; at rest the unit vector opposed to gravity
  bool force_known = false;             ///< finite and long enough to have a direction
};

/// Reads one report. Blobs that are not finite, outside the image, all zero or within 2 pixels of an earlier one are
/// left out; so is an acceleration that is not finite or shorter than 0.05 g (free fall has no direction) or longer
/// than 8 g (beyond any accelerometer of a Wii Remote). Returns false, and reads nothing, for fewer than kChannelsMin
/// channels.
[[nodiscard]] bool read_channels(std::span<const double> channels, Reading& reading);

/// The accelerometer's axes in R: (x, y, z)_R = (a_x, a_z, -a_y); and back.
[[nodiscard]] inline Vector3d remote_from_accelerometer(const Vector3d& a) {
  return {a.x(), a.z(), -a.y()};
}
[[nodiscard]] inline Vector3d accelerometer_from_remote(const Vector3d& f_R) {
  return {f_R.x(), -f_R.z(), f_R.y()};
}

}  // namespace verisim::wii
