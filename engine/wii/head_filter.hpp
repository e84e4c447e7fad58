// The state of the scaat tracker: an error-state Kalman filter over a head that moves with nearly constant velocity,
// fed one scalar at a time (Welch and Bishop, SCAAT, SIGGRAPH 1997; dissertation section 2.9).
//
// State, all in coordinates R of the remote: position p, velocity v, orientation R_RH, angular velocity w. The error is
// (dp, dv, dtheta, dw) with R_RH = exp([dtheta]x) R_RH_estimate, its covariance P is 12 x 12. White acceleration of
// density S (linear, m^2/s^3) and S_w (angular, rad^2/s^3) drives it.
#pragma once

#include "engine/wii/pose_solver.hpp"

namespace verisim::wii {

class HeadFilter {
 public:
  using Matrix12d = Eigen::Matrix<double, 12, 12>;
  using Vector12d = Eigen::Matrix<double, 12, 1>;

  HeadFilter() = default;
  explicit HeadFilter(const Thresholds& thresholds) : thresholds_(thresholds) {}

  /// Starts at a pose in R with its covariance; at rest, give or take 0.5 m/s and 1 rad/s.
  /// @pre the pose is finite, its rotation unit; the covariance is finite
  void start(const Pose& X_RH, const Matrix6d& covariance);

  /// How much of the head the last report showed: two of three LEDs are a pair.
  enum class View { all, pair, one, none };
  /// Moves on by dt seconds. Where the full view ends, the mean velocities of the last 0.1 s take over from the
  /// momentary ones, which are noisier, and what is no longer seen dies away within 0.4 s: rotation always (with a pair
  /// within 0.08 s), motion along the ray with one LED, all motion with none. @pre dt is finite and not negative
  void predict(double dt, View view);

  /// One scalar whose prediction is off by `residual`, with gradient (g_p, g_theta) and variance `variance`. Refused,
  /// and false, when the residual is beyond `gate` standard deviations of what was expected.
  /// @pre variance > 0
  bool correct(const Vector3d& g_p, const Vector3d& g_theta, double residual, double variance, double gate);

  /// The same for an LED that is alone in view. Only motion across its ray is corrected; depth and orientation stay as
  /// they are, with their uncertainty (a Schmidt-Kalman update): one LED tells nothing of them, but would, through
  /// rounding and acceleration, claim to. @pre variance > 0
  bool correct_across(const Vector3d& g_p, const Vector3d& g_theta, double residual, double variance, double gate);

  [[nodiscard]] const Pose& X_RH() const { return X_RH_; }
  [[nodiscard]] const Matrix3d& R_RH() const { return R_RH_; }
  [[nodiscard]] const Vector3d& velocity() const { return v_; }
  /// Of (p, theta) in R.
  [[nodiscard]] Matrix6d covariance() const;
  /// Of the expected position, the worst direction's variance or more: the trace [m^2].
  [[nodiscard]] double position_variance() const { return P_.diagonal().head<3>().sum(); }

 private:
  void turn(const Vector3d& rotation);
  void slow_down(double keep, View view);
  void move(const Vector12d& error);

  Thresholds thresholds_;
  Pose X_RH_;
  Matrix3d R_RH_ = Matrix3d::Identity();  ///< = X_RH_.rotation
  Vector3d v_ = Vector3d::Zero();
  Vector3d w_ = Vector3d::Zero();
  Vector3d v_slow_ = Vector3d::Zero();
  Vector3d w_slow_ = Vector3d::Zero();
  View view_ = View::all;
  Matrix12d P_ = Matrix12d::Identity();
};

}  // namespace verisim::wii
