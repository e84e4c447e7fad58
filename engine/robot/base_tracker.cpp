#include "engine/robot/base_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim::robot {

namespace {

const BaseTrackerSettings& checked(const BaseTrackerSettings& s, std::string_view name) {
  const auto refuse = [name](const char* what, double is, const char* range) {
    fail(ErrorKind::input, "tracker '{}': {} is {} but must be {}", name, what, is, range);
  };
  if (!(s.rate > 0 && s.rate <= 1000)) refuse("rate", s.rate, "above 0 and at most 1000 Hz; 60 is usual");
  if (!(s.latency >= 0 && s.latency <= 1)) refuse("latency", s.latency, "from 0 to 1 s");
  if (!is_not_negative(s.sigma_position)) refuse("sigma_position", s.sigma_position, "finite, 0 m or above");
  if (!is_not_negative(s.sigma_yaw)) refuse("sigma_yaw", s.sigma_yaw, "finite, 0 rad or above");
  if (!is_not_negative(s.dropout_rate)) refuse("dropout_rate", s.dropout_rate, "finite, 0 per s or above");
  if (!is_positive(s.dropout_mean)) refuse("dropout_mean", s.dropout_mean, "above 0 s");
  if (!(s.lost_after > s.latency + 1 / s.rate)) refuse("lost_after", s.lost_after, "above latency + 1 / rate");
  for (const Outage& outage : s.outages)
    if (!(outage.from < outage.to)) refuse("the end of an outage", outage.to, "after its beginning");
  return s;
}

std::string stream(std::string_view name, const char* of) {
  return std::string(name) + of;
}

}  // namespace

BaseTracker::BaseTracker(const BaseTrackerSettings& settings, std::uint64_t seed, std::string_view name)
    : settings_(checked(settings, name)),
      dropouts_(seed, stream(name, "/dropout")),
      lengths_(seed, stream(name, "/dropout length")),
      noise_x_(seed, stream(name, "/x")),
      noise_y_(seed, stream(name, "/y")),
      noise_yaw_(seed, stream(name, "/yaw")),
      latency_ms_(static_cast<std::uint64_t>(std::llround(settings.latency * 1000))),
      under_way_(latency_ms_ + 2) {
  tracked_.age = std::numeric_limits<double>::infinity();
}

bool BaseTracker::is_dropped(std::uint64_t k) {
  const double t = static_cast<double>(k) / settings_.rate;
  // In the time of one sample a dropout begins with probability 1 - exp(-dropout_rate / rate).
  if (t >= dropout_until_ && dropouts_.uniform(k) < 1 - pinned::exp(-settings_.dropout_rate / settings_.rate))
    dropout_until_ = t - settings_.dropout_mean * pinned::log(1 - lengths_.uniform(k));
  return t < dropout_until_ || std::any_of(settings_.outages.begin(), settings_.outages.end(),
                                           [t](const Outage& o) { return o.from <= t && t < o.to; });
}

void BaseTracker::take(const PlanarPose& pose) {
  const std::uint64_t k = samples_++;
  if (is_dropped(k) || is_hidden_) {
    ++dropped_;
    return;
  }
  PlanarPose measured = pose;
  if (is_swapped_) std::swap(measured.x, measured.y);
  measured.x += settings_.sigma_position * noise_x_.normal(k);
  measured.y += settings_.sigma_position * noise_y_.normal(k);
  measured.theta += settings_.sigma_yaw * noise_yaw_.normal(k);
  VERISIM_ASSERT(count_ < under_way_.size());
  under_way_[(first_ + count_++) % under_way_.size()] = {now_, now_ + latency_ms_, measured};
}

const TrackedBase& BaseTracker::advance(const PlanarPose& pose) {
  VERISIM_ASSERT(std::isfinite(pose.x) && std::isfinite(pose.y) && std::isfinite(pose.theta));
  const double ends = static_cast<double>(now_ + 1) / 1000;
  if (static_cast<double>(samples_) / settings_.rate < ends) take(pose);
  tracked_.is_new = false;
  while (count_ > 0 && under_way_[first_].due <= now_) {
    tracked_.pose = under_way_[first_].pose;
    measured_at_ = under_way_[first_].taken;
    tracked_.is_new = has_report_ = true;
    first_ = (first_ + 1) % under_way_.size();
    --count_;
  }
  if (has_report_) tracked_.age = static_cast<double>(now_ - measured_at_) / 1000;
  tracked_.is_valid = tracked_.age <= settings_.lost_after;
  seen_.see(tracked_.is_valid, now_);
  ++now_;
  return tracked_;
}

}  // namespace verisim::robot
