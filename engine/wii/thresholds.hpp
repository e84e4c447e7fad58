// What trackers take for near, likely, still or lost: the numbers of theirs that no formula gives.
//
// Heuristic: chosen on the trajectories and sensors of validate.hpp. How little their errors hang on each number is in
// wii_thresholds_test. Numbers that are limits of the task stand where they are used (admission.hpp: how far and how
// fast heads are), those of the sensor in channels.hpp.
#pragma once

namespace verisim::wii {

struct Thresholds {
  // How heads move (head_filter.cpp). Densities on natural motions whose amplitudes fall as f^-0.5 to f^-2 with their
  // frequencies: lower lags behind the lively ones, higher lets the pixel noise of the calm ones through.
  double linear_density = 0.7;   ///< m^2/s^3
  double angular_density = 0.5;  ///< rad^2/s^3
  /// rad^2/s^3. While LEDs are missing, a turn looks like a motion. With the density of fast heads the filter would
  /// explain every motion as a turn.
  double guessed_density = 0.1;
  double unseen_density = 8;  ///< times as much once nothing is seen: the head may do anything
  double decay = 0.4;         ///< s, of a motion that is no longer seen
  /// s. Two LEDs of three cannot tell a turn from coming nearer. A turn that is predicted for too long becomes an error
  /// of depth.
  double pair_decay = 0.08;
  double slow = 0.1;  ///< s, of the mean velocities that take over from the momentary ones, which are noisier

  // Which blob is which LED (assignment.cpp, acquisition.cpp, multi_point.cpp, scaat.cpp).
  double clutter_radius = 12;    ///< pixel; lamps stand still, unless the remote is moved
  double pair_cost_max = 6;      ///< a tilt of 90 degrees costs 4, sizes that differ by two cost 4: both are no head
  double cost_margin = 2;        ///< tilt and rounded sizes of a true pair cost less
  double cost_per_led_max = 12;  ///< per LED seen: beyond any pixel noise, so not this head
  double gate_sigmas = 5;        ///< of what a measurement was expected to be
  double pixel_gate = 15;        ///< pixel, beside what the state's uncertainty allows
  double gate = 60;              ///< pixel, of trackers without a filter: a head's motion between two reports
  double gate_growth = 1500;     ///< pixel per s without a report: 1.1 m/s at 1 m

  // The prior, and what is sure enough.
  double sigma_max = 0.15;    ///< m: less sure than this is not valid
  double upright_time = 1;    ///< s: the prior pulls with this time constant where LEDs decide
  double prior_width = 2;     ///< times the settings' sigmas: where yaw is seen, the prior should hardly count
  double roll_sigma = 0.5;    ///< rad, about how far heads are tilted
  double turn_rate = 0.3;     ///< rad/s: how fast a yaw that is no longer seen becomes unknown
  double still_known = 0.02;  ///< rad, of a yaw that was seen one report ago
};

}  // namespace verisim::wii
