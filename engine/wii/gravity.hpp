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

/// The direction of gravity, smoothed: readings count for about `time_constant`, the first one at once. A remote that
/// tilts steadily is followed without lag (the filter knows a rate: double exponential smoothing, both poles at the
/// time constant). Readings whose length says that the remote is shaken (outside 1 +- 0.3 g) are left out once a
/// direction is known.
class GravityFilter {
 public:
  /// @pre the time constant is finite and above 0
  explicit GravityFilter(double time_constant, const Thresholds& thresholds = {});

  /// One reading [g], `dt` seconds after the one before. Constant time, no allocation.
  /// @pre dt is finite and not negative; the reading is finite and has a direction
  void add(double dt, const Vector3d& force_R);
  void forget() { known_ = false; }

  [[nodiscard]] bool known() const { return known_; }
  /// @pre known()
  [[nodiscard]] const Matrix3d& C_LR() const {
    VERISIM_ASSERT(known_);
    return C_LR_;
  }

 private:
  double time_constant_;                     ///< s
  double shaken_, gap_max_, direction_min_;  ///< g, s, g: see Thresholds
  bool known_ = false;
  Vector3d up_R_ = Vector3d::UnitY();
  Vector3d rate_R_ = Vector3d::Zero();  ///< 1/s
  Matrix3d C_LR_ = Matrix3d::Identity();
};

}  // namespace verisim::wii
