// The head pose that fits any number of sightings best, from one remote or two: Gauss-Newton on pixels. A prior (heads
// are nearly upright) counts as further measurements, so that it decides what the sightings leave open.
#pragma once

#include <array>
#include <span>

#include "engine/wii/tracker.hpp"

namespace verisim::wii {

/// One LED in the image of one remote.
struct Sighting {
  Vector3d p_H = Vector3d::Zero();  ///< of the LED [m]
  double u = 0;                     ///< pixel
  double v = 0;                     ///< pixel
  int remote = 0;
};

inline constexpr int kSightingsMax = 2 * kLedsMax;

/// The prior of the head's rotation. For R_LH = Rz(roll) Ry(yaw) Rx(pitch) the third row of R_LH is
/// (-sin yaw, cos yaw sin pitch, …): the prior gives its first two entries, with these standard deviations.
struct Upright {
  Matrix3d C_LR = Matrix3d::Identity();  ///< of the first remote
  double row_x = 0;                      ///< R_LH(2,0) a priori
  double row_y = 0;                      ///< R_LH(2,1) a priori
  double sigma_x = 1;                    ///< rad, of yaw
  double sigma_y = 1;                    ///< rad, of pitch
  double sigma_roll = 1;                 ///< rad, of R_LH(1,0) about 0
};

struct SolvedPose {
  Pose X_RH;                               ///< in coordinates of the first remote
  Matrix6d covariance = Matrix6d::Zero();  ///< of position and rotation vector in R [m^2, rad^2]
  double cost = 0;                         ///< sum of squared residuals over their variances
  bool found = false;                      ///< converged with every LED in front of its remote
};

class PoseSolver {
 public:
  /// @pre pixel_sigma > 0; the second remote's placement is finite, its rotation unit
  explicit PoseSolver(const TrackerSettings& settings);

  /// From `start`, at most 20 steps, usually 2, a step that makes it worse halved, each about 100 flops per sighting
  /// and a 6 x 6 factorisation. No allocation. @pre at most kSightingsMax sightings, of remotes 0 and 1; the beliefs'
  /// sigmas are above 0
  [[nodiscard]] SolvedPose solve(std::span<const Sighting> sightings, const Upright& upright, const Pose& start) const;
  /// The pixel at which a remote sees a point of the head; false if it lies behind the lens.
  /// @pre remote is 0 or 1
  [[nodiscard]] bool project(const Pose& X_RH, const Vector3d& p_H, int remote, Eigen::Vector2d& pixel) const;

 private:
  struct Normal;
  [[nodiscard]] bool accumulate(std::span<const Sighting> sightings, const Upright& upright, const Pose& X_RH,
                                Normal& normal) const;

  Pinhole pinhole_;
  double weight_;    ///< 1 / pixel variance
  double step_max_;  ///< m or rad, see Thresholds::solver_step_max
  std::array<Matrix3d, 2> R_iR_;
  std::array<Vector3d, 2> p_iR_;
};

/// X_LH and its covariance in L from a pose in R, with tilt of `tilt_variance` [rad^2] (add_tilt).
void level(const SolvedPose& solved, const Matrix3d& C_LR, double tilt_variance, Pose& X_LH, Matrix6d& covariance);

}  // namespace verisim::wii
