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

  /// Starts at a pose in R with its covariance; at rest, give or take 0.5 m/s and 1 rad/s.
  void start(const Pose& X_RH, const Matrix6d& covariance);

  /// Moves on by dt seconds. `seen`: LEDs were seen lately; else velocities die away within 0.25 s, so that a head that
  /// is not seen stays where it was last.
  void predict(double dt, bool seen);

  /// One scalar whose prediction is off by `residual`, with gradient (g_p, g_theta) and variance `variance`. Refused,
  /// and false, when the residual is beyond `gate` standard deviations of what was expected.
  bool correct(const Vector3d& g_p, const Vector3d& g_theta, double residual, double variance, double gate);

  [[nodiscard]] const Pose& X_RH() const { return X_RH_; }
  [[nodiscard]] const Matrix3d& R_RH() const { return R_RH_; }
  [[nodiscard]] const Vector3d& velocity() const { return v_; }
  /// Of (p, theta) in R.
  [[nodiscard]] Matrix6d covariance() const;
  /// Of the expected position, the worst direction's variance or more: the trace [m^2].
  [[nodiscard]] double position_variance() const { return P_.diagonal().head<3>().sum(); }

 private:
  void turn(const Vector3d& rotation);

  Pose X_RH_;
  Matrix3d R_RH_ = Matrix3d::Identity();  ///< = X_RH_.rotation
  Vector3d v_ = Vector3d::Zero();
  Vector3d w_ = Vector3d::Zero();
  Matrix12d P_ = Matrix12d::Identity();
};

}  // namespace verisim::wii
