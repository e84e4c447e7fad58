// From the accelerometer to levelled coordinates L: +y opposed to gravity, +z the horizontal projection of the lens
// axis, +x = y x z, origin at the pinhole (reference/wii/README.md). Heading is not observable; this choice keeps it
// the remote's own.
#pragma once

#include "engine/base/error.hpp"
#include "engine/base/pose.hpp"
#include "engine/wii/thresholds.hpp"

namespace verisim::wii {

/// C_LR with v_L = C_LR v_R = Rx(-pitch) Rz(roll) v_R, from any vector along "up" in R. No trigonometry.
/// A lens that points straight up or down has no horizontal projection: roll is then taken as 0.
/// @pre up_R is finite and not zero
[[nodiscard]] Matrix3d levelling(const Vector3d& up_R);

/// Adds to the covariance of (position, rotation vector) in L what tilt of C_LR about either horizontal axis does, with
/// its `variance` [rad^2]: it turns everything about the pinhole. Where the lens points up or down, roll turns the
/// heading too, for that is the lens axis's projection. @pre variance is finite and not negative
void add_tilt(Matrix6d& covariance, const Vector3d& p_L, const Matrix3d& C_LR, double variance);

/// The direction of gravity, by one of two models, whichever tells the readings better, weighed as interacting multiple
/// models are (Blom and Bar-Shalom 1988):
///   at rest  the mean of all readings since the remote came to rest, from the first one on: 1/n of each;
///   moving   double exponential smoothing, both poles at `time_constant`: a remote that tilts steadily is followed
///            without lag.
/// How far readings scatter is learned from their differences, so that the better accelerometer is trusted sooner.
/// Readings whose length says that the remote is shaken (outside 1 +- 0.3 g) are left out once a direction is known.
class GravityFilter {
 public:
  /// @pre the time constant is finite and above 0
  explicit GravityFilter(double time_constant, const Thresholds& thresholds = {});

  /// One reading [g], `dt` seconds after the one before. Constant time, no allocation.
  /// @pre dt is finite and not negative; the reading is finite and has a direction
  void add(double dt, const Vector3d& force_R);
  void forget() { *this = GravityFilter(time_constant_, thresholds_); }

  [[nodiscard]] bool known() const { return known_; }
  /// @pre known()
  [[nodiscard]] const Matrix3d& C_LR() const {
    VERISIM_ASSERT(known_);
    return C_LR_;
  }
  /// How likely it is that the remote rests.
  [[nodiscard]] double rest() const { return rest_; }
  /// Variance of C_LR's tilt about either horizontal axis [rad^2], as far as scattered readings make it: a constant
  /// error of the accelerometer is not seen.
  [[nodiscard]] double tilt_variance() const { return tilt_variance_; }

 private:
  /// A direction [g] and its variance, as a multiple of one reading's.
  struct Mean {
    Vector3d up_R = Vector3d::UnitY();
    double variance = 1;
  };
  void start(const Vector3d& force_R);
  void learn_scatter(double dt, const Vector3d& force_R);
  /// How far a reading is from what a model foresaw [g^2, over three axes], and the variance per axis that it foresaw,
  /// as a multiple of one reading's.
  struct Surprise {
    double square, variance;
  };
  Surprise follow(double dt, const Vector3d& force_R);
  Surprise average(double dt, const Vector3d& force_R);
  void weigh(const Surprise& resting, const Surprise& moving, double share);
  void conclude();

  double time_constant_;  ///< s
  Thresholds thresholds_;
  bool known_ = false;
  Vector3d last_R_ = Vector3d::Zero();  ///< the reading before
  double scatter_ = 0;                  ///< variance of one reading about its mean, per axis [g^2]
  double readings_ = 0;                 ///< that the scatter and the moving mean rest on
  Mean resting_, moving_;
  Vector3d rate_R_ = Vector3d::Zero();  ///< 1/s
  double rest_ = 0;
  double tilt_variance_ = 0;
  Matrix3d C_LR_ = Matrix3d::Identity();
};

}  // namespace verisim::wii
