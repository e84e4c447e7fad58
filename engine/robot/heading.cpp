#include "engine/robot/heading.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim::robot {

namespace {

constexpr double kHeadingStep = 0.001;  // s: one call

const HeadingSettings& checked(const HeadingSettings& s) {
  const auto refuse = [](const char* what, double is, const char* range) {
    fail(ErrorKind::input, "heading: {} is {} but must be {}", what, is, range);
  };
  if (!is_not_negative(s.p)) refuse("p", s.p, "finite, 0 per s or above; 2 is usual");
  if (!is_not_negative(s.i)) refuse("i", s.i, "finite, 0 or above");
  if (!is_positive(s.omega_max)) refuse("omega_max", s.omega_max, "above 0 rad/s");
  if (!std::isfinite(s.desired)) refuse("desired", s.desired, "finite");
  if (!(s.clearance >= 0 && s.clearance <= pinned::kPi / 2)) refuse("clearance", s.clearance, "from 0 to pi / 2");
  if (!is_positive(s.lost_after)) refuse("lost_after", s.lost_after, "above 0 s");
  if (!(s.p * s.lost_after < 1)) refuse("p x lost_after", s.p * s.lost_after, "below 1, or a held command overshoots");
  return s;
}

}  // namespace

double wrapped(double angle) {
  const double turned = angle - pinned::kFullTurn * std::round(angle / pinned::kFullTurn);
  return turned <= -pinned::kPi ? turned + pinned::kFullTurn : turned;
}

double heading_clear_of_sight(double now, double sight, double neutral, double clearance) {
  const double phi = wrapped(now + neutral - sight);
  const double off = std::abs(phi);
  const double clear = std::clamp(off, clearance, pinned::kPi - clearance);
  // The nearest clear angle is on the same side of the line; on the line itself, on the left of it.
  const double turn = phi >= 0 && off < pinned::kPi ? clear - off : off - clear;
  return now + turn;
}

Heading::Heading(const HeadingSettings& settings, double neutral)
    : settings_(checked(settings)), neutral_(neutral), desired_(settings.desired) {
  VERISIM_ASSERT(std::isfinite(neutral));
}

double Heading::advance(const TrackedBase& tracked, const std::optional<double>& sight) {
  is_on_ = settings_.p > 0 && tracked.age < settings_.lost_after;
  ++since_ms_;
  if (!is_on_) return command_ = 0;
  if (!tracked.is_new) return command_;
  const double since = std::min(static_cast<double>(since_ms_) * kHeadingStep, settings_.lost_after);
  since_ms_ = 0;
  if (settings_.clearance > 0 && sight)
    desired_ = heading_clear_of_sight(tracked.pose.theta, *sight, neutral_, settings_.clearance);
  const double error = wrapped(desired_ - tracked.pose.theta);
  const double wanted = settings_.p * error + settings_.i * integral_;
  command_ = std::clamp(wanted, -settings_.omega_max, settings_.omega_max);
  if (command_ == wanted) integral_ += error * since;
  return command_;
}

}  // namespace verisim::robot
