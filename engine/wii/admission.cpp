#include "engine/wii/admission.hpp"

#include <cmath>

#include "engine/base/error.hpp"

namespace verisim::wii {
bool Admission::reachable(const Place& from, double t, double variance, const Vector3d& p_L) const {
  if (!from.set) return false;
  const double way = kWithin * kSpeedMax * std::abs(t - from.t);
  const double square = (p_L - from.p_L).squaredNorm();
  if (square <= way * way) return true;  // nearly always: no square root
  const double limit = way + slack_sigmas_ * std::sqrt(variance);
  return square <= limit * limit;
}

Admission::Verdict Admission::judge(double t, double variance, Vector3d& p_L) {
  VERISIM_ASSERT(std::isfinite(t));
  const double square = p_L.squaredNorm();
  if (!(square >= kDistanceMin * kDistanceMin && square <= kDistanceMax * kDistanceMax)) return Verdict::refused;

  const bool remembered = last_.set && std::abs(t - last_.t) <= kSilenceMax;
  if (remembered && reachable(last_, t, variance, p_L)) {
    const Vector3d step = p_L - last_.p_L;
    const double limit = kWithin * kSpeedMax * std::abs(t - last_.t);
    if (step.squaredNorm() > limit * limit) p_L = last_.p_L + step * (limit / step.norm());
    // Drawn towards the last place, a pose on the far shell can only come nearer; on the near one the chord may cut in.
    if (p_L.squaredNorm() < kDistanceMin * kDistanceMin) return Verdict::refused;
    last_ = {true, t, p_L};
    candidate_.set = false;
    return Verdict::continued;
  }
  if (!remembered || reachable(candidate_, t, variance, p_L)) {
    last_ = {true, t, p_L};
    candidate_.set = false;
    return Verdict::elsewhere;
  }
  candidate_ = {true, t, p_L};
  return Verdict::refused;
}

}  // namespace verisim::wii
