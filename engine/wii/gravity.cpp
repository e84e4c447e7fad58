#include "engine/wii/gravity.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim::wii {
namespace {

constexpr double kEvidenceMax = 3;  // of one reading, in log-odds: however far off, it decides nothing alone
constexpr double kRepeated = 0.6;  // of a reading that counts when it repeats the one before: rounding may have made it
constexpr double kScatterReadings = 5;  // that the scatter before the first reading is worth

}  // namespace

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

void add_tilt(Matrix6d& covariance, const Vector3d& p_L, const Matrix3d& C_LR, double variance) {
  VERISIM_ASSERT(is_not_negative(variance));
  const double sin_pitch = C_LR(1, 2);
  const double cos_pitch = std::sqrt(std::max(1e-4, 1 - sin_pitch * sin_pitch));
  Vector6d pitch;
  pitch << Vector3d::UnitX().cross(p_L), Vector3d::UnitX();
  const Vector3d roll_axis(0, sin_pitch / cos_pitch, 1);
  Vector6d roll;
  roll << roll_axis.cross(p_L), roll_axis;
  covariance += variance * (pitch * pitch.transpose() + roll * roll.transpose());
}

GravityFilter::GravityFilter(double time_constant, const Thresholds& thresholds)
    : time_constant_(time_constant), thresholds_(thresholds) {
  VERISIM_ASSERT(is_positive(time_constant));
}

void GravityFilter::add(double dt, const Vector3d& force_R) {
  VERISIM_ASSERT(is_not_negative(dt));
  VERISIM_ASSERT(is_finite(force_R));
  VERISIM_ASSERT(!force_R.isZero(0));
  if (!known_) {
    start(force_R);
  } else {
    const bool shaken = std::abs(force_R.norm() - 1) > thresholds_.shaken;
    if (shaken || dt > thresholds_.gravity_gap) rate_R_.setZero();
    if (shaken) return;
    learn_scatter(dt, force_R);
    const Surprise resting = average(dt, force_R);
    const Surprise moving = follow(dt, force_R);
    weigh(resting, moving, force_R == last_R_ ? kRepeated : 1);
  }
  last_R_ = force_R;
  conclude();
}

void GravityFilter::start(const Vector3d& force_R) {
  known_ = true;
  scatter_ = thresholds_.scatter * thresholds_.scatter;
  readings_ = 1;
  resting_ = moving_ = {force_R, 1};
  rest_ = 0.5;
}

void GravityFilter::learn_scatter(double dt, const Vector3d& force_R) {
  // Half the square of a difference; what a remote turns by between two readings is little beside it.
  const double here = (force_R - last_R_).squaredNorm() / 6;
  const double share = std::max(1 / (readings_ + kScatterReadings), dt / (thresholds_.scatter_time + dt));
  scatter_ = std::max(scatter_ + share * (here - scatter_), thresholds_.scatter_min * thresholds_.scatter_min);
  ++readings_;
}

GravityFilter::Surprise GravityFilter::average(double dt, const Vector3d& force_R) {
  // The remote may have come to rest since the last reading, and then its direction is the moving one's.
  const double stops = (1 - rest_) * std::min(0.5, dt / thresholds_.moving_for);
  const double stays = rest_ * (1 - std::min(0.5, dt / thresholds_.resting_for));
  rest_ = stays + stops;
  const double new_share = stops / rest_;
  const Vector3d apart = moving_.up_R - resting_.up_R;
  resting_.variance += new_share * (moving_.variance - resting_.variance) +
                       new_share * (1 - new_share) * apart.squaredNorm() / (3 * scatter_);
  resting_.up_R += new_share * apart;

  const Vector3d innovation = force_R - resting_.up_R;
  const double expected = 1 + resting_.variance;
  resting_.up_R += resting_.variance / expected * innovation;
  resting_.variance /= expected;
  return {innovation.squaredNorm(), expected};
}

GravityFilter::Surprise GravityFilter::follow(double dt, const Vector3d& force_R) {
  const double keep = time_constant_ / (time_constant_ + dt);
  const double gain = std::max(1 / readings_, 1 - keep * keep);
  const Vector3d expected = moving_.up_R + dt * rate_R_;
  const Vector3d innovation = force_R - expected;
  const Vector3d mixed = expected + gain * innovation;
  if (gain * readings_ > 1) rate_R_ += (1 - keep) / (time_constant_ + dt) * innovation;
  const bool opposed = mixed.norm() < thresholds_.direction_min;
  moving_ = {opposed ? force_R : mixed, gain};
  if (opposed) rate_R_.setZero();
  return {innovation.squaredNorm(), 1 / (1 - gain)};
}

void GravityFilter::weigh(const Surprise& resting, const Surprise& moving, double share) {
  const double evidence = 1.5 * pinned::log(moving.variance / resting.variance) +
                          0.5 * (moving.square / moving.variance - resting.square / resting.variance) / scatter_;
  const double odds = rest_ / (1 - rest_) * pinned::exp(std::clamp(share * evidence, -kEvidenceMax, kEvidenceMax));
  rest_ = odds / (1 + odds);
}

void GravityFilter::conclude() {
  const Vector3d apart = resting_.up_R - moving_.up_R;
  const Vector3d up_R = moving_.up_R + rest_ * apart;
  C_LR_ = levelling(up_R.norm() < thresholds_.direction_min ? moving_.up_R : up_R);
  tilt_variance_ = scatter_ * (moving_.variance + rest_ * (resting_.variance - moving_.variance)) +
                   rest_ * (1 - rest_) * apart.squaredNorm() / 2;
}

}  // namespace verisim::wii
