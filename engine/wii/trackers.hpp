// One factory per tracker, for the table in tracker.cpp alone: it checks what a tracker needs. make_tracker
// (tracker.hpp) is the door for everyone else.
#pragma once

#include <memory>

#include "engine/wii/tracker.hpp"

namespace verisim::wii {

/// Two LEDs, closed form, no memory but for which blob is which. Yaw and pitch are reported as 0 with the variance of
/// what heads do.
[[nodiscard]] std::unique_ptr<Tracker> make_geometric(const TrackerSettings& settings);

/// What VRPN's vrpn_Tracker_WiimoteHead computes, slips included (reference/wii/UPSTREAM.md).
[[nodiscard]] std::unique_ptr<Tracker> make_vrpn_compatible(const TrackerSettings& settings);

/// Three or four LEDs and one remote: yaw is told from distance.
/// @pre three LEDs or more
[[nodiscard]] std::unique_ptr<Tracker> make_three_led(const TrackerSettings& settings);

/// An error-state Kalman filter that takes one measurement at a time, two LEDs or more (scaat.cpp).
[[nodiscard]] std::unique_ptr<Tracker> make_scaat(const TrackerSettings& settings);

/// Two remotes. Reports come with the first remote's readings, in its levelled coordinates; with the second's while the
/// first has been silent for 0.05 s.
/// @pre settings.X_R1R2 says where the second remote stands
[[nodiscard]] std::unique_ptr<Tracker> make_stereo(const TrackerSettings& settings);

}  // namespace verisim::wii
