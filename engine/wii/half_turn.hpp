// Which way round a pair of equal LEDs is: a head and the same head turned over show the same image.
//
// Two hypotheses, weighed by Bayes' rule. Heads are seldom rolled far: the prior is a von Mises density of
// concentration 1 / roll_sigma^2 with a broad floor, for people do lie down. A pair that is followed from report to
// report stays the way it is; only what is never upright comes into doubt, slowly. Where it was not seen, the last roll
// and the prior say how likely either way is.
#pragma once

#include "engine/base/pose.hpp"
#include "engine/wii/thresholds.hpp"

namespace verisim::wii {

/// Cosine and sine of the roll of a head whose x axis this is in L; of roll 0 where that points along z.
[[nodiscard]] Eigen::Vector2d roll_of(const Vector3d& x_L);

/// Constant time and size.
class HalfTurn {
 public:
  explicit HalfTurn(const Thresholds& thresholds = {}) : thresholds_(thresholds) {}

  /// The probability that a pair which shows a head rolled by the angle of this cosine and sine is the other way round,
  /// and the head half a turn from it. Above 0.5 exchange the two, and take 1 less this.
  /// @pre t is finite; cosine and sine are those of an angle, to rounding
  [[nodiscard]] double doubt(double t, double cos_roll, double sin_roll) const;
  /// This roll was reported.
  void follow(double t, double cos_roll, double sin_roll);
  void forget() { known_ = false; }
  /// Of the roll, where it may be half a turn off with this probability [rad^2].
  [[nodiscard]] static double variance(double doubt);

 private:
  /// Of heads [1/rad] by the cosine of their roll.
  [[nodiscard]] double density(double cos_roll) const;
  /// Logarithm of how much likelier this way round is than the other.
  [[nodiscard]] double evidence(double t, double cos_roll, double sin_roll) const;

  Thresholds thresholds_;
  bool known_ = false;
  double t_ = 0;
  double cos_roll_ = 1;
  double sin_roll_ = 0;
  double evidence_ = 0;
};

}  // namespace verisim::wii
