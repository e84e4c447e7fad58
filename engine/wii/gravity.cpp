#include "engine/wii/gravity.hpp"

#include <cmath>

#include "engine/base/contract.hpp"

namespace verisim::wii {
Matrix3d levelling(const Vector3d& up_R) {
  VERISIM_ASSERT(is_finite(up_R));
  VERISIM_ASSERT(!up_R.isZero(0));
  const Vector3d up = up_R.normalized();
  const double cos_p = std::sqrt(up.x() * up.x() + up.y() * up.y());
  const double sin_p = up.z();
  const bool upright = cos_p > 1e-9;
  const double cos_r = upright ? up.y() / cos_p : 1;
  const double sin_r = upright ? up.x() / cos_p : 0;
  Matrix3d C;
  C << cos_r, -sin_r, 0,                    //
      cos_p * sin_r, cos_p * cos_r, sin_p,  // = up
      -sin_p * sin_r, -sin_p * cos_r, cos_p;
  return C;
}

GravityFilter::GravityFilter(double time_constant, const Thresholds& thresholds)
    : time_constant_(time_constant),
      shaken_(thresholds.shaken),
      gap_max_(thresholds.gravity_gap),
      direction_min_(thresholds.direction_min) {
  VERISIM_ASSERT(is_positive(time_constant));
}

void GravityFilter::add(double dt, const Vector3d& force_R) {
  VERISIM_ASSERT(is_not_negative(dt));
  VERISIM_ASSERT(is_finite(force_R));
  VERISIM_ASSERT(!force_R.isZero(0));
  if (!known_) {
    up_R_ = force_R;
    rate_R_.setZero();
  } else {
    const bool shaken = std::abs(force_R.norm() - 1) > shaken_;
    if (shaken || dt > gap_max_) rate_R_.setZero();
    if (shaken || (force_R == up_R_ && rate_R_.isZero(0))) return;
    const double keep = time_constant_ / (time_constant_ + dt);
    const Vector3d expected = up_R_ + dt * rate_R_;
    const Vector3d innovation = force_R - expected;
    const Vector3d mixed = expected + (1 - keep * keep) * innovation;
    rate_R_ += (1 - keep) / (time_constant_ + dt) * innovation;
    const bool opposed = mixed.norm() < direction_min_;
    up_R_ = opposed ? force_R : mixed;
    if (opposed) rate_R_.setZero();
  }
  known_ = true;
  C_LR_ = levelling(up_R_);
}

}  // namespace verisim::wii
