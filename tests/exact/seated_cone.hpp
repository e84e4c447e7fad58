// The taper of scenarios/seats.lua in its seat: both cones and all rims lie on each other. A hand brings it from above,
// a millimetre beside the axis, 2 mm deeper than it goes, presses and turns it there.
#pragma once

#include "tests/exact/held_pin.hpp"

namespace verisim::exact::test {

inline constexpr double kSeatHeight = 0.06;
inline constexpr int kSeatSteps = 1500;

/// `wider`: m, the seat's radius over the taper's.
[[nodiscard]] inline HeldBody seated_cone(double wider = 0, double spacing = 0.002, const BodyOptions& options = {},
                                          const SearchThresholds& thresholds = {}) {
  const auto cone = [](double more) { return make(Solid::Kind::cone, {0.015 + more, 0.035 + more, kSeatHeight}); };
  const Solid seat = combine(Solid::Kind::difference, make(Solid::Kind::box, {0.12, 0.12, kSeatHeight}), cone(wider));
  // 20 kg/m^3; the centre of mass is taken where the origin is.
  HeldBody held(body_of(seat, spacing, {}, options), body_of(cone(0), spacing, {}, options), 2.48e-3,
                {1.2e-6, 1.2e-6, 9.2e-7}, thresholds);
  held.stiffness = 300;
  held.damping = 2 * std::sqrt(300 * 2.48e-3);
  held.angular_stiffness = 0.5;
  held.X_WB.position = {0.001, 0, 0.015};
  return held;
}

[[nodiscard]] inline Hand hand_over_seat(double t) {
  constexpr double kSpeed = 0.1;
  const double depth = std::min(0.017, kSpeed * t);
  const double shake = 2e-4;
  Hand hand;
  hand.position = {0.001 + shake * std::sin(55 * t), shake * std::sin(47 * t), 0.015 - depth};
  hand.rotation = rotation_from_vector({0, 0, std::clamp(t - 0.5, 0.0, 0.5) * 0.7});
  hand.velocity = {0, 0, depth < 0.017 ? -kSpeed : 0};
  return hand;
}

}  // namespace verisim::exact::test
