// A body pressed on a wall by its weight: the discrete mass-spring-damper of ORACLES section 2, made of the engine's
// own contacts. World coordinates, z up; the wall's face is z = 0.
//
//        .------------------.     plate: makes the body slow to tilt, so that heaving is its fastest mode
//        '------.    .------'
//               |foot|            7 x 7 points of the foot's face touch: one spring and damper, K and B along z
//     ==========|====|==========
//
// The stability rule of contacts is off (SimulationParameters::stability_rule): with it the bound is never met. K and B
// are what the contacts' force shows: its change with depth and with speed, taken from single frames of the same scene.
#pragma once

#include "engine/stability/watch.hpp"

namespace verisim::stability {

struct PressedBody {
  double mass = 1;             ///< kg
  double step = 1e-3;          ///< s
  double stiffness = 1000;     ///< N/m per contact (contactStiffness)
  double damping_ratio = 0.1;  ///< contactDampingRatio
  Integrator integrator = Integrator::semi_implicit;
  bool stability_rule = false;
};

/// The contact along z, as one frame of the engine shows it, where the body rests.
struct Response {
  double force = 0;      ///< N
  double stiffness = 0;  ///< K [N/m]
  double damping = 0;    ///< B [N s/m]
  std::uint64_t contacts = 0;
};
[[nodiscard]] Response response_of(const PressedBody& body);

/// K dt^2/m + 2 B dt/m: stable below 4 (semi-implicit Euler), always (backward Euler).
[[nodiscard]] double budget_of(const PressedBody& body, const Response& response);

/// Begins a two-hundredth of a voxel from where it rests.
[[nodiscard]] Verdict press(const PressedBody& body, const Patience& patience = {128, 9});

/// The stiffness K at which stability ends [N/m], by bisection over contactStiffness to a thousandth, and the budget of
/// the stability rule there: in theory 4.
struct PressedBound {
  double stiffness = 0, budget = 0;
};
[[nodiscard]] std::optional<PressedBound> bound_of(PressedBody body, const Patience& patience = {128, 9});

}  // namespace verisim::stability
