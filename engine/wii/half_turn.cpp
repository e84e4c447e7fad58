#include "engine/wii/half_turn.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim::wii {
namespace {

constexpr double kSure = 40;          // seen upright for long: no longer in doubt, but not for ever
constexpr double kDensityMin = 1e-5;  // 1/rad, of a head that stands on its crown

/// The density [1/rad] of an angle of this cosine about its mean, to a few per cent.
double von_mises(double cosine, double concentration) {
  return std::sqrt((concentration + 1 / (2 * pinned::kPi)) / (2 * pinned::kPi)) *
         pinned::exp(concentration * (cosine - 1));
}

}  // namespace

Eigen::Vector2d roll_of(const Vector3d& x_L) {
  const double across = x_L.head<2>().norm();
  return across > 1e-3 ? Eigen::Vector2d(x_L.head<2>() / across) : Eigen::Vector2d(1, 0);
}

double HalfTurn::density(double cos_roll) const {
  const double concentration = 1 / (thresholds_.roll_sigma * thresholds_.roll_sigma);
  return von_mises(cos_roll, concentration) + thresholds_.lying * (1 + cos_roll) / (2 * pinned::kPi) + kDensityMin;
}

double HalfTurn::evidence(double t, double cos_roll, double sin_roll) const {
  const double here = density(cos_roll);
  const double there = density(-cos_roll);
  const double upright = pinned::log(here / there);
  if (!known_) return upright;

  const double gap = std::abs(t - t_);
  const double unseen = std::max(0.0, gap - thresholds_.seen_gap);
  if (unseen == 0) return evidence_ + upright * gap / thresholds_.posture_time;
  // What the roll was says what it is; the less, the longer nobody saw it. What was believed may have been wrong.
  const double spread = thresholds_.roll_noise + thresholds_.roll_speed * unseen;
  const double cos_turned = cos_roll * cos_roll_ + sin_roll * sin_roll_;
  const double kept = pinned::exp(-unseen / thresholds_.posture_kept);
  const double same = kept * von_mises(cos_turned, 1 / (spread * spread));
  const double other = kept * von_mises(-cos_turned, 1 / (spread * spread));
  const double right = 1 / (1 + pinned::exp(-evidence_));
  return pinned::log((right * same + (1 - right) * other + (1 - kept) * here) /
                     (right * other + (1 - right) * same + (1 - kept) * there));
}

double HalfTurn::doubt(double t, double cos_roll, double sin_roll) const {
  VERISIM_ASSERT(std::isfinite(t));
  VERISIM_ASSERT(std::abs(cos_roll * cos_roll + sin_roll * sin_roll - 1) < kUnitTolerance);
  return 1 / (1 + pinned::exp(evidence(t, cos_roll, sin_roll)));
}

void HalfTurn::follow(double t, double cos_roll, double sin_roll) {
  evidence_ = std::clamp(evidence(t, cos_roll, sin_roll), -kSure, kSure);
  known_ = true;
  t_ = t;
  cos_roll_ = cos_roll;
  sin_roll_ = sin_roll;
}

double HalfTurn::variance(double doubt) {
  return doubt * pinned::kPi * pinned::kPi;
}

}  // namespace verisim::wii
