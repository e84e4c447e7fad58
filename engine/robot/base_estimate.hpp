// Where the base is now, of reports that are late and come 60 times a second. The pose goes into the haptic loop, which
// feels every jump: at 0.45 m/s a report later moves the handle by 7.5 mm at once, and a coupling of 300 N/m renders 2
// N.
//
//   at a report that was taken at time s, with innovation e = z - x(s):   x += alpha e,   v += beta e / T
//   at any time t:   y(t) = x(s) + v min(t - s, horizon) + o(t),   o decays by exp(-t / smoothing)
//
// The alpha-beta filter (Kalata 1984: beta = alpha^2 / (2 - alpha) for a base that accelerates at random), then a
// straight line to now. What a report corrects is taken up by o, so that y is continuous. Floor coordinates F: x, y
// [m], theta [rad], continuous over whole turns. No allocation; 30 ns a step.
#pragma once

#include <array>

#include "engine/robot/mecanum.hpp"

namespace verisim::robot {

struct EstimateParameters {
  double alpha = 0.6;       ///< 0 to 1; 1: every report is believed
  double horizon = 0.1;     ///< s; without a report for longer it stands still
  double smoothing = 0.02;  ///< s; 0: what a report says is taken at once
};

class BaseEstimate {
 public:
  using Place = std::array<double, 3>;  ///< x, y, theta

  /// @pre start is finite; 0 < alpha <= 1; horizon and smoothing are finite and not negative
  BaseEstimate(const Place& start, const EstimateParameters& parameters);
  /// A report of where it was at time `taken` [s]. A report not later than the one before is left out.
  /// @pre place and taken are finite
  void hear(const Place& place, double taken);
  /// Where it is at time t [s]. @pre t is finite and not before that of the last call
  void advance(double t);
  [[nodiscard]] const Place& place() const { return now_; }
  [[nodiscard]] const Place& velocity() const { return v_; }  ///< m/s, m/s, rad/s

 private:
  [[nodiscard]] Place straight(double t) const;

  EstimateParameters parameters_;
  bool heard_ = false;
  double taken_ = 0, t_ = 0;  ///< s
  Place x_, v_{}, offset_{}, now_;
};

[[nodiscard]] inline BaseEstimate::Place place_of(const PlanarPose& pose) {
  return {pose.x, pose.y, pose.theta};
}

}  // namespace verisim::robot
