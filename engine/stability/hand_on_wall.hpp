// A hand that holds a device at a virtual wall: the experiment of Colgate and of Abbott and Okamura (ORACLES section
// 2), made of the engine's own parts.
//
//     hand and handle        hardware model                 virtual coupling        body
//     m, b, friction  ----  steps of the encoder,   ----    K, B (the wall)  ----   so heavy that it
//                           period T, delay                                         stays where it is
//
// The device moves between the samples: a frame is a part of the period. The hardware model samples the handle every T
// and holds the force for T. The coupling's damper sees the whole way of a period within one frame, so that B dt/T is
// the coupling's, and B (x_k - x_(k-1))/T what the hand feels. The delay is half on the way in, half on the way out.
#pragma once

#include "engine/stability/watch.hpp"

namespace verisim::stability {

struct HandOnWall {
  double mass = 0.4;          ///< kg
  double damping = 0.8;       ///< b [N s/m], of the device
  double stiffness = 1000;    ///< K [N/m]
  double wall_damping = 0;    ///< B [N s/m]
  double period = 1e-3;       ///< T [s]
  unsigned periods_late = 0;  ///< t_d / T
  double resolution = 0;      ///< m, a step of the encoder
  double friction = 0;        ///< N, dry, of the device
  unsigned frames = 20;       ///< of a period
  double push = 1e-3;         ///< m, how far from rest it begins
};

/// The bound of stability of a mass with much inertia [N/m]: (b + B) / (T/2 + t_d).
[[nodiscard]] double stable_stiffness(const HandOnWall& hand);
/// Colgate's bound of passivity [N/m]: 2 (b - B)/T. Abbott and Okamura's is the lesser of 2 b/T and twice the friction
/// by a step of the encoder.
[[nodiscard]] double passive_stiffness(const HandOnWall& hand);

/// The hand's motion, once it is `push` away from where wall and hand are in balance. Where friction or steps of the
/// encoder let it rest near that place, too, its speed is judged, as the way that it would swing.
/// @pre mass, stiffness, period, push are above 0; frames is even
[[nodiscard]] Verdict hold(const HandOnWall& hand, unsigned blocks_max = 8);

/// The stiffness at which stability ends [N/m], by bisection to a five-hundredth between 50 and 50,000.
[[nodiscard]] std::optional<double> bound_of(HandOnWall hand);

/// Time-domain energy observer (ORACLES section 2), at the port of the operator: moves the handle to and fro, `way` m
/// about `about`, a straight line in each period, and sums what the device's damper and friction take, less what the
/// wall gives. Of this energy a passive device never gives any back. J, of whole cycles in which nothing is stored.
/// @pre way > 0
[[nodiscard]] double energy_taken(const HandOnWall& hand, double way, double about, unsigned cycles = 50);

/// The stiffness at which the device stops being passive [N/m], by bisection to a thousandth: there is a way to move it
/// that gets energy out of it. Ways of `ways` m about edges and middles of the encoder's steps are tried.
[[nodiscard]] std::optional<double> passive_bound_of(HandOnWall hand, const std::vector<double>& ways);

}  // namespace verisim::stability
