// How much of space a remote can track: eq. 2.1 and 2.2 of the dissertation, as printed and corrected, and a count that
// needs neither (ORACLES R7 and slip 2).
#pragma once

#include <cstdint>

#include "engine/wii/pinhole.hpp"

namespace verisim::wii {

// Of all: @pre spacing and distances are finite and not negative, d1 <= d2; where heads are counted, count > 0.

/// Eq. 2.1: the area of the plane at distance d [m] in which both LEDs, `spacing` [m] apart along x, are in view [m^2].
/// Exact for a head that only moves; 0 where the LEDs do not fit.
[[nodiscard]] double trackable_area(const FieldOfView& fov, double spacing, double d);

/// Eq. 2.2 as printed: (A(d2) d2 - A(d1) d1) / 3, the volume of a true frustum [m^3]. A(d) is none: its term in
/// -spacing keeps the frustum from ending in a point.
[[nodiscard]] double trackable_volume_as_printed(const FieldOfView& fov, double spacing, double d1, double d2);

/// Eq. 2.2 corrected: the integral of A over d,
/// (4/3) tan(h/2) tan(v/2) (d2^3 - d1^3) - spacing tan(v/2) (d2^2 - d1^2).
/// @pre the LEDs fit at d1: 2 d1 tan(h/2) >= spacing
[[nodiscard]] double trackable_volume(const FieldOfView& fov, double spacing, double d1, double d2);

/// A Monte-Carlo figure and its standard error.
struct Counted {
  double value = 0;
  double standard_error = 0;
};
/// Heads drawn evenly from the plane (volume: the box) that the view fits in, and shown to the ideal virtual remote.
[[nodiscard]] Counted count_trackable_area(const FieldOfView& fov, double spacing, double d, std::uint64_t count,
                                           std::uint64_t seed);
[[nodiscard]] Counted count_trackable_volume(const FieldOfView& fov, double spacing, double d1, double d2,
                                             std::uint64_t count, std::uint64_t seed);

}  // namespace verisim::wii
