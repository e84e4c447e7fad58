// What trackers take for near, likely, still or lost: the numbers of theirs that no formula gives.
//
// Heuristic: chosen on the trajectories and sensors of validate.hpp. How little their errors hang on each number is in
// wii_thresholds_test, and half_turn_test for those of a pair that may be the other way round; those that say "not
// measured" are asked for by none of these trajectories and sensors, at a thousandth or a thousand times their value.
// Numbers that are limits of the task stand where they are used (admission.hpp: how far and how fast heads are), those
// of the sensor in channels.hpp, those of the search for the remote's place in place.hpp.
#pragma once

#include "engine/wii/pinhole.hpp"

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
  double slow = 0.1;         ///< s, of the mean velocities that take over from the momentary ones, which are noisier
  double start_speed = 0.5;  ///< m/s, standard deviation of a head's that was just found: heads at work are slow
  double start_spin = 1;     ///< rad/s, likewise
  double spin_max = 15;      ///< rad/s: faster than any head turns
  double slack_turn =
      0.5;  ///< rad that measuring noise may turn a head by beyond that, however unsure it is; not measured
  double velocity_gain = 0.5;  ///< share of the newest difference in the velocity of trackers without a filter

  // Which blob is which LED (assignment.cpp, acquisition.cpp, multi_point.cpp, scaat.cpp).
  double clutter_radius = 12;  ///< pixel; lamps stand still, unless the remote is moved
  double pair_cost_max = 6;  ///< a tilt of 90 degrees costs 4, sizes that differ by two cost 8: the latter are no pair
  double cost_margin = 2;    ///< tilt and rounded sizes of a true pair cost less
  double cost_per_led_max = 12;         ///< per LED seen: beyond any pixel noise, so not this head
  double acquisition_cost_per_led = 5;  ///< per LED of a head that is found: its shape, and how upright it is
  double gate_sigmas = 5;               ///< of what a measurement was expected to be
  double pixel_gate = 15;               ///< pixel, beside what the state's uncertainty allows
  double gate = 60;                     ///< pixel, of trackers without a filter: a head's motion between two reports
  double gate_growth = 1500;            ///< pixel per s without a report: 1.1 m/s at 1 m
  double pixel_gate_max = 200;          ///< pixel, of a filter, however unsure it is: a fifth of the image
  double spread_gate = 3;    ///< standard deviations of the state that the filter's gate is widened by; not measured
  double pair_gate = 20;     ///< pixel, of a pair that is followed, beside half its spacing and its speed; not measured
  double pair_speed = 2000;  ///< pixel per s: 1.5 m/s at 1 m, for gaps of some reports
  double pair_memory = 0.25;          ///< s that a pair is followed for; a head needs longer to roll over
  double lost_head_memory = 0.25;     ///< s that a lost head is looked for where it was
  double size_scale = 0.7;            ///< blob size units, of a pair's difference: 1 costs 2, as rounding makes it
  double size_learning = 0.02;        ///< per report: cells run down slowly, and brightness with them
  double size_cost_max = 2;           ///< sizes of real sensors follow distance badly: a hint, no proof; not measured
  double repetition_learning = 0.02;  ///< per coordinate pair
  double size_sigma = 0.5;            ///< blob size units: a size is a whole number
  double size_spread = 1.5;           ///< likewise, of all LEDs of a head: they shine to where it looks
  double size_repeats = 50;           ///< reports that show the same rounding error of a size
  double led_scale = 10;          ///< pixel: how near further LEDs are to where the pair alone puts them; not measured
  double missing_led_cost = 100;  ///< of a further LED that is nowhere near its place; not measured
  int confirmations = 5;          ///< images in a row that confirm a jump to another pair
  int unassigned_reports = 5;     ///< with blobs that no LED explains, before a head is acquired anew …
  int unassigned_reports_filter = 3;  ///< … by scaat, which is surer of where LEDs are
  double start_turn = 0.6;       ///< rad of yaw to start from, to either side: Gauss-Newton finds its way from there
  double solver_step_max = 0.7;  ///< m or rad in one step of Gauss-Newton: the tangent is not trusted further
  double forward_min = 0.2;      ///< least z_L of a ray: steeper ones are nearly parallel to the plane they must cross

  // Two remotes.
  double other_remote_max = 0.03;  ///< s: three reports; an older image of the other remote is no use
  double lone_blob_memory = 0.05;  ///< s for which a blob that is alone in one image is the LED that it was
  double both_silent = 0.05;       ///< s without the first remote after which the second reports

  // Gravity (gravity.cpp).
  double shaken = 0.3;          ///< g off 1: the reading holds more than gravity
  double gravity_gap = 0.25;    ///< s; a rate says nothing after a longer gap
  double direction_min = 0.1;   ///< g; opposed readings can average to nothing
  double scatter = 0.005;       ///< g, of a reading about its mean, before there are readings
  double scatter_min = 0.0003;  ///< g: no accelerometer is better
  double scatter_time = 1;      ///< s that the scatter is learned over
  double resting_for = 10;      ///< s, mean time that a remote rests
  double moving_for = 2;        ///< s, likewise moves

  // The prior, and what is sure enough.
  double sigma_max = 0.15;  ///< m: less sure than this is not valid
  double slack_sigmas =
      4;  ///< that a head may seem to move or turn faster than heads do (admission.hpp, tracker_base.cpp)
  double coast_max = 0.1;       ///< s without any LED that a prediction still counts as valid
  double forget_after = 1;      ///< s without any LED after which nothing is predicted any more
  double pinned = 1 * kDegree;  ///< rad: with two LEDs, yaw and pitch are held at zero to this, not estimated
  double upright_time = 1;      ///< s: the prior pulls with this time constant where LEDs decide
  double prior_width = 2;       ///< times the settings' sigmas: where yaw is seen, the prior should hardly count
  double roll_sigma = 0.5;      ///< rad, about how far heads are tilted
  double lying = 0.02;          ///< share of heads that are tilted much farther (half_turn.hpp)
  double roll_speed = 1;        ///< rad/s that a head may roll by while it is not seen
  double roll_noise = 0.1;      ///< rad, likewise at once
  double seen_gap = 0.05;       ///< s between reports that see a pair: it does not turn over in between
  double posture_kept = 3;      ///< s for which a head that is not seen stays as it was
  double posture_time = 10;     ///< s in which seeing a head upright, or not, counts as much as seeing it at first
  double turn_rate = 0.3;       ///< rad/s: how fast a yaw that is no longer seen becomes unknown
  double still_known = 0.02;    ///< rad, of a yaw that was seen one report ago
};

}  // namespace verisim::wii
