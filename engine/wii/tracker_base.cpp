#include "engine/wii/tracker_base.hpp"

#include <cmath>

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim::wii {
namespace {

constexpr double kBackMax = 1;  // s, promised in tracker.hpp: a clock that goes further back belongs to a new recording

}  // namespace

TrackerBase::TrackerBase(const TrackerSettings& settings)
    : settings_(settings),
      pinhole_(settings.fov),
      gravity_{GravityFilter(settings.gravity_time_constant, settings.thresholds),
               GravityFilter(settings.gravity_time_constant, settings.thresholds)},
      last_t_{kNever, kNever},
      admission_(settings.thresholds.slack_sigmas) {
  report_.pose.position.setConstant(std::numeric_limits<double>::quiet_NaN());
  report_.pose.rotation.coeffs().setConstant(std::numeric_limits<double>::quiet_NaN());
  report_.covariance.setConstant(std::numeric_limits<double>::quiet_NaN());
}

bool TrackerBase::accept_time(double t, int remote, double& dt) {
  if (!std::isfinite(t)) return false;
  double& last = last_t_[static_cast<std::size_t>(remote)];
  if (t < last - kBackMax) {
    last_t_.fill(kNever);
    for (GravityFilter& gravity : gravity_) gravity.forget();
    admission_.forget();
    restart();
  } else if (t <= last) {
    return false;
  }
  dt = std::isfinite(last) ? t - last : 0;
  last = t;
  return true;
}

const Report& TrackerBase::update(double t, std::span<const double> channels, int remote) {
  VERISIM_ASSERT(remote >= 0);
  VERISIM_ASSERT(remote < kRemotes);
  report_.news = false;
  report_.reacquired = false;
  Reading reading;
  double dt = 0;
  if (!read_channels(channels, reading) || !accept_time(t, remote, dt)) return report_;

  GravityFilter& gravity = gravity_[static_cast<std::size_t>(remote)];
  if (reading.force_known) gravity.add(dt, reading.force_R);
  Estimate result;
  if (gravity.known()) estimate(t, dt, reading, remote, result);
  if (reports(t, remote)) conclude(t, result);
  return report_;
}

bool TrackerBase::turned_too_fast(double dt, const Pose& pose) const {
  // |q . q'| is the cosine of half the angle. A rounding must not be told from a turn.
  const double half = 0.5 * settings_.thresholds.spin_max * std::abs(dt) * 0.999;
  return half < pinned::kPi / 2 && std::abs(report_.pose.rotation.dot(pose.rotation)) < pinned::cos(half);
}

void TrackerBase::conclude(double t, Estimate& result) {
  const bool was_valid = report_.valid;
  const double before = report_.t;
  Admission::Verdict verdict = Admission::Verdict::refused;
  if (result.usable) {
    const Vector3d measured = result.pose.position;
    const double variance = result.covariance.diagonal().head<3>().maxCoeff();
    verdict = admission_.judge(t, variance, result.pose.position);
    const Vector3d drawn = result.pose.position - measured;
    if (!drawn.isZero(0)) result.covariance.topLeftCorner<3, 3>() += drawn * drawn.transpose();
  }
  report_.t = t;
  report_.news = true;
  report_.valid = verdict != Admission::Verdict::refused;
  report_.reacquired = report_.valid && (!was_valid || verdict == Admission::Verdict::elsewhere ||
                                         turned_too_fast(t - before, result.pose));
  if (report_.valid || (result.known && !result.usable)) {
    report_.pose = result.pose;
    report_.covariance = result.covariance;
  }
  admitted(t, report_.valid);
}

const Report& TrackerBase::heartbeat(double t) {
  report_.news = false;
  report_.reacquired = false;
  if (!(t - report_.t <= kSilenceMax)) report_.valid = false;
  return report_;
}

}  // namespace verisim::wii
