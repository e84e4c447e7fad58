// A pin in a hole at any clearance, judged from the pin's pose: its axis may be off the hole's by the clearance, and no
// more.
#pragma once

#include "engine/stability/row.hpp"

namespace verisim::stability {

struct Fit {
  double radius = 0.02;     ///< m, of the pin
  double clearance = 1e-3;  ///< of the radius
  double spin = 0;          ///< rad/s, about the axis
  std::uint64_t frames = 500;
};

/// The pin falls sideways onto the wall of the hole and stays. Expected: it overlaps by less than a spring of steel
/// gives way to its weight and its fall, and then lies; it gains no energy; a spin stays, to a thousandth.
[[nodiscard]] Row fit(const std::string& what, const Fit& fit);

}  // namespace verisim::stability
