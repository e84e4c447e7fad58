// One factory per tracker; make_tracker (tracker.hpp) is the door for everyone else.
#pragma once

#include <memory>

#include "engine/wii/tracker.hpp"

namespace verisim::wii {

/// Two LEDs, closed form, no memory but for which blob is which. Yaw and pitch are reported as 0 with the variance of
/// what heads do.
[[nodiscard]] std::unique_ptr<Tracker> make_geometric(const TrackerSettings& settings);

/// What VRPN's vrpn_Tracker_WiimoteHead computes, slips included (reference/wii/UPSTREAM.md).
[[nodiscard]] std::unique_ptr<Tracker> make_vrpn_compatible(const TrackerSettings& settings);

}  // namespace verisim::wii
