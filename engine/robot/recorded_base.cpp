#include "engine/robot/recorded_base.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/robot/odometry.hpp"

namespace verisim::robot {
namespace {

Counts rounded(const std::array<double, 4>& counts) {
  Counts whole{};
  for (std::size_t i = 0; i < whole.size(); ++i) whole[i] = static_cast<std::int64_t>(std::floor(counts[i] + 0.5));
  return whole;
}

/// Where the base is in each row, from (0, 0, 0) on: the recorded pose, or what the counts come to.
std::vector<PlanarPose> places_of(const EncoderSamples& samples, const MecanumGeometry& geometry) {
  std::vector<PlanarPose> places;
  if (!samples.pose.empty()) {
    for (const auto& [x, y, theta] : samples.pose) places.push_back({x, y, theta});
    return places;
  }
  Odometry odometry(WheelMap(counts_per_displacement(geometry, kCountsPerWheelTurn)), {}, rounded(samples.counts[0]));
  for (const auto& counts : samples.counts) places.push_back(odometry.advance(rounded(counts)));
  return places;
}

/// `places` such that the first one is `start`.
void begin_at(const PlanarPose& start, std::vector<PlanarPose>& places) {
  const PlanarPose first = places.front();
  const double turn = start.theta - first.theta, c = pinned::cos(turn), s = pinned::sin(turn);
  for (PlanarPose& place : places) {
    const double x = place.x - first.x, y = place.y - first.y;
    place = {start.x + c * x - s * y, start.y + s * x + c * y, place.theta + turn};
  }
}

}  // namespace

RecordedBase::RecordedBase(RobotSettings settings, EncoderSamples samples)
    : settings_(std::move(settings)),
      samples_(std::move(samples)),
      tracker_(settings_.tracker, settings_.seed, settings_.name + " tracker"),
      estimate_(place_of(settings_.start), settings_.estimate),
      place_(settings_.start) {
  VERISIM_ASSERT(!samples_.t.empty());
  VERISIM_ASSERT(samples_.counts.size() == samples_.t.size());
  VERISIM_ASSERT(samples_.pose.empty() || samples_.pose.size() == samples_.t.size());
  places_ = places_of(samples_, settings_.plant.geometry);
  begin_at(settings_.start, places_);
  X_WB_ = tracked_X_WB_ = base_in_world(place_, settings_.device);
}

PlanarPose RecordedBase::place_at(double t) {
  while (row_ + 1 < samples_.t.size() && samples_.t[row_ + 1] <= t) ++row_;
  const PlanarPose& a = places_[row_];
  if (row_ + 1 == samples_.t.size()) return a;
  const PlanarPose& b = places_[row_ + 1];
  const double s = std::clamp((t - samples_.t[row_]) / (samples_.t[row_ + 1] - samples_.t[row_]), 0.0, 1.0);
  return {a.x + s * (b.x - a.x), a.y + s * (b.y - a.y), a.theta + s * (b.theta - a.theta)};
}

void RecordedBase::advance(double t) {
  VERISIM_ASSERT(std::isfinite(t));
  for (const auto due = static_cast<std::uint64_t>(t / kMillisecond + 1e-6); done_ < due; ++done_) {
    const double now = static_cast<double>(done_ + 1) * kMillisecond;
    const TrackedBase& tracked = tracker_.advance(place_at(now));
    if (tracked.is_new) estimate_.hear(place_of(tracked.pose), now - tracked.age);
  }
  place_ = place_at(t);
  estimate_.advance(t);
  X_WB_ = base_in_world(place_, settings_.device);
  const auto [x, y, theta] = estimate_.place();
  tracked_X_WB_ = base_in_world({x, y, theta}, settings_.device);
}

void RecordedBase::report(PartNotes& notes) {
  if (!std::exchange(is_said_, true))
    notes.add("robot", "is moved by a recording: what drives it, its walls and its reaction change nothing");
  tracker_.report(notes);
}

void RecordedBase::declare(Columns& columns) const {
  const std::string state = "/state/robot/" + name() + "/";
  columns.add(state + "pose", "m, m, rad",
              "middle of the wheels on the floor: x, y (the world's -z), heading; recorded",
              [this] { return place_of(place_); });
  columns.add(state + "tracked_pose", "m, m, rad", "the same, as the tracker and the estimate from it say",
              [this] { return estimate_.place(); });
  columns.add(state + "tracked", "1", "1: the tracker's last report is not too old",
              [this] { return tracker_.tracked().is_valid; });
  columns.add(state + "encoder", "1", "recorded counts of the motors' encoders",
              [this] { return samples_.counts[row_]; });
}

}  // namespace verisim::robot
