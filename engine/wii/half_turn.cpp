#include "engine/wii/half_turn.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim::wii {
namespace {

constexpr double kSure = 40;         // seen upright for seconds: no longer in doubt, but not for ever
constexpr double kDensityMin = 1e-4;  // of a head that stands on its crown, beside one that is upright

}  // namespace

Eigen::Vector2d roll_of(const Vector3d& x_L) {
  const double across = x_L.head<2>().norm();
  return across > 1e-3 ? Eigen::Vector2d(x_L.head<2>() / across) : Eigen::Vector2d(1, 0);
}

double HalfTurn::evidence(double t, double cos_roll, double sin_roll) const {
  const double concentration = 1 / (thresholds_.roll_sigma * thresholds_.roll_sigma);
  const auto density = [&](double cosine) {
    return pinned::exp(concentration * (cosine - 1)) + thresholds_.lying * (1 + cosine) / 2 + kDensityMin;
  };
  const double upright = pinned::log(density(cos_roll) / density(-cos_roll));
  if (!known_) return upright;

  const double gap = std::abs(t - t_);
  const double spread = thresholds_.roll_noise + thresholds_.roll_speed * gap;
  const double same_way = 2 * (cos_roll * cos_roll_ + sin_roll * sin_roll_) / (spread * spread);
  double kept = std::copysign(std::min(std::abs(evidence_), std::abs(same_way)), evidence_ * same_way);
  if (std::abs(kept) < kSure / 2) {
    // Right before and the same way, or wrong before and the other way.
    const double right = 1 / (1 + pinned::exp(-evidence_));
    const double same = 1 / (1 + pinned::exp(-same_way));
    const double now = right * same + (1 - right) * (1 - same);
    kept = pinned::log(now / (1 - now));
  }
  return kept + upright * std::min(1.0, gap / thresholds_.upright_time);
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
