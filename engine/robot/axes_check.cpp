#include "engine/robot/axes_check.hpp"

#include <cmath>
#include <limits>

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/robot/heading.hpp"

namespace verisim::robot {

namespace {

constexpr std::uint64_t kStride = 100, kStrideMost = 500;  // ms; what took longer spans a dropout and tells little
constexpr std::uint64_t kRing = 4096;                      // ms of commands that are kept
constexpr double kForget = 2.0;                            // s
constexpr double kArm = 0.3;                               // m, Nexus: half base plus half track
constexpr double kEnough = 0.05 * 0.05;                    // m^2
constexpr double kTold = 0.005 * 0.005;                    // m^2 in a stride: above the tracker's noise
constexpr double kFastest = 1.5;                           // m/s, of a base that rolls or slips
constexpr double kFollows = 0.3, kTurnsBack = -0.5, kIdle = 0.1;

std::uint64_t in_milliseconds(double lag) {
  if (!(lag >= 0 && lag <= 1)) fail(ErrorKind::input, "check of axes: lag is {} s but must be from 0 to 1", lag);
  return static_cast<std::uint64_t>(std::llround(lag * 1000));
}

}  // namespace

AxesCheck::AxesCheck(double lag) : lag_ms_(in_milliseconds(lag)), commanded_(kRing) {}

void AxesCheck::forget() {
  has_last_ = is_wrong_ = is_idle_ = false;
  cross_ = commanded_squares_ = {};
  idle_squares_ = 0;
}

const PlanarPose& AxesCheck::commanded_at(std::uint64_t ms) const {
  return commanded_[(ms < lag_ms_ ? 0 : ms - lag_ms_) % kRing];
}

void AxesCheck::advance(const std::optional<PlanarTwist>& command, const TrackedBase& tracked) {
  PlanarPose sum = commanded_[now_ % kRing];
  ++now_;
  if (command) {
    VERISIM_ASSERT(std::isfinite(command->vx));
    VERISIM_ASSERT(std::isfinite(command->vy));
    VERISIM_ASSERT(std::isfinite(command->omega));
    sum.x += command->vx * 0.001;
    sum.y += command->vy * 0.001;
    sum.theta += command->omega * 0.001;
  } else {
    unknown_until_ = now_ + lag_ms_;
  }
  commanded_[now_ % kRing] = sum;
  if (!tracked.is_new) return;
  const auto age = static_cast<std::uint64_t>(std::llround(tracked.age * 1000));
  const std::uint64_t taken = now_ > age ? now_ - age : 0;
  const std::uint64_t length = taken - last_taken_;
  if (has_last_ && length < kStride) return;
  const bool is_told = now_ - last_taken_ + lag_ms_ < kRing;  // what was commanded in it is still known
  const bool is_known = last_taken_ >= unknown_until_;
  if (has_last_ && length <= kStrideMost && is_told && is_known) take_stride(tracked, taken);
  last_ = tracked.pose;
  last_taken_ = taken;
  has_last_ = true;
}

void AxesCheck::take_stride(const TrackedBase& tracked, std::uint64_t taken) {
  const PlanarPose &from = commanded_at(last_taken_), &to = commanded_at(taken);
  const double turn = wrapped(tracked.pose.theta - last_.theta);
  const double heading = last_.theta + turn / 2;  // that of the middle: the error is of third order in the turn
  const double c = pinned::cos(heading), s = pinned::sin(heading);
  const double dx = tracked.pose.x - last_.x, dy = tracked.pose.y - last_.y;
  const std::array<double, 3> moved{c * dx + s * dy, -s * dx + c * dy, kArm * turn};
  const std::array<double, 3> told{to.x - from.x, to.y - from.y, kArm * (to.theta - from.theta)};
  double stride_moved = 0, stride_told = 0, all_told = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    stride_moved += moved[i] * moved[i];
    stride_told += told[i] * told[i];
  }
  const double seconds = 0.001 * static_cast<double>(taken - last_taken_);
  const double kept = pinned::exp(-seconds / kForget);
  const bool jumps = stride_moved > kFastest * kFastest * seconds * seconds;  // no base does: a tracker set up anew
  const bool stands = stride_told > kTold && stride_moved < kIdle * stride_told;
  idle_squares_ = kept * idle_squares_ + (stands ? stride_told : 0);
  const bool slips = std::abs(turn) > 1.5 * std::abs(to.theta - from.theta) + 0.02;
  for (std::size_t i = 0; i < 3; ++i) {
    const bool counts = !stands && !jumps && !(i == 2 && slips);
    cross_[i] = kept * cross_[i] + (counts ? told[i] * moved[i] : 0);
    commanded_squares_[i] = kept * commanded_squares_[i] + (counts ? told[i] * told[i] : 0);
    all_told += commanded_squares_[i];
  }
  is_idle_ = idle_squares_ > kEnough && idle_squares_ > all_told;
  const std::array<double, 3> f = followed();  // comparisons with NaN are false
  is_wrong_ = is_wrong_ || f[0] < kFollows || f[1] < kFollows || f[2] < kTurnsBack;
}

std::array<double, 3> AxesCheck::followed() const {
  std::array<double, 3> f{};
  for (std::size_t i = 0; i < 3; ++i)
    f[i] =
        commanded_squares_[i] > kEnough ? cross_[i] / commanded_squares_[i] : std::numeric_limits<double>::quiet_NaN();
  return f;
}

}  // namespace verisim::robot
