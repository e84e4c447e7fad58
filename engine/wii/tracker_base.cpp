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

Upright TrackerBase::upright() const {
  Upright u;
  u.C_LR = gravity(0).C_LR();
  u.sigma_x = settings_.thresholds.prior_width * settings_.yaw_sigma;
  u.sigma_y = settings_.thresholds.prior_width * settings_.pitch_sigma;
  u.sigma_roll = settings_.thresholds.roll_sigma;
  return u;
}

bool TrackerBase::turned_too_fast(double dt, Estimate& result) const {
  const Thresholds& n = settings_.thresholds;
  const double limit = kWithin * n.spin_max * std::abs(dt);
  const Quaterniond turn = (result.pose.rotation * report_.pose.rotation.conjugate()).normalized();
  // |w| is the cosine of half the angle: nearly always no more than this is computed.
  if (limit >= pinned::kPi || std::abs(turn.w()) >= pinned::cos(limit / 2)) return false;
  const Vector3d turned = vector_from_rotation(turn);
  const double sigma = std::sqrt(result.covariance.diagonal().tail<3>().maxCoeff());
  if (turned.norm() > limit + std::min(n.slack_sigmas * sigma, n.slack_turn)) return true;
  const Vector3d kept = turned * (limit / turned.norm());
  const Vector3d drawn = turned - kept;
  result.pose.rotation = (rotation_from_vector(kept) * report_.pose.rotation).normalized();
  result.covariance.bottomRightCorner<3, 3>() += drawn * drawn.transpose();
  return false;
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
  report_.reacquired =
      report_.valid && (!was_valid || verdict == Admission::Verdict::elsewhere || turned_too_fast(t - before, result));
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
