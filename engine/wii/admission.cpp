#include "engine/wii/admission.hpp"

namespace verisim::wii {
namespace {

constexpr double kSlackSigmas = 4;
// A limit kept in exact arithmetic would be missed by a rounding in a reader's check: stay a little below it.
constexpr double kWithin = 0.999;

}  // namespace

bool Admission::reachable(const Place& from, double t, double slack, const Vector3d& p_L) {
  return from.set && (p_L - from.p_L).norm() <= kWithin * kSpeedMax * (t - from.t) + slack;
}

Admission::Verdict Admission::judge(double t, double sigma, Vector3d& p_L) {
  const double distance = p_L.norm();
  if (!(distance >= kDistanceMin && distance <= kDistanceMax)) return Verdict::refused;

  const double slack = kSlackSigmas * sigma;
  const bool remembered = last_.set && t - last_.t <= kSilenceMax;
  if (remembered && reachable(last_, t, slack, p_L)) {
    const Vector3d step = p_L - last_.p_L;
    const double limit = kWithin * kSpeedMax * (t - last_.t);
    if (step.norm() > limit) p_L = last_.p_L + step * (limit / step.norm());
    // Drawn towards the last place, a pose on the far shell can only come nearer; on the near one the chord may cut in.
    if (p_L.norm() < kDistanceMin) return Verdict::refused;
    last_ = {true, t, p_L};
    candidate_.set = false;
    return Verdict::continued;
  }
  if (!remembered || reachable(candidate_, t, slack, p_L)) {
    last_ = {true, t, p_L};
    candidate_.set = false;
    return Verdict::elsewhere;
  }
  candidate_ = {true, t, p_L};
  return Verdict::refused;
}

}  // namespace verisim::wii
