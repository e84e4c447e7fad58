#include "engine/device/hand/peg_search.hpp"

#include <cmath>

#include "engine/base/pinned_math.hpp"

namespace verisim {
namespace {

constexpr double kSettling = 0.3;              // s, to a place that is kept; a choice
constexpr double kCycle = 3;                   // s, of one direction of a tilt; a choice
constexpr int kDirections = 13;                // of a tilt, until it gives up
constexpr double kTurn = 0.38196601125010515;  // of a full turn between directions: the golden section leaves no gap

/// Minimum jerk from 0 at `from` to 1 at `to`.
double ramp(double x, double from, double to) {
  const double s = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return s * s * s * (10 - s * (15 - 6 * s));
}

}  // namespace

void PegSearch::begin(double t, const HandGoal& goal, const Vector3d& axis) {
  VERISIM_ASSERT(is_unit(axis));
  VERISIM_ASSERT(goal.strategy != PegStrategy::straight);
  center_ = at(t).place;
  goal_ = goal;
  axis_ = axis;
  u_ = axis.unitOrthogonal();
  v_ = axis.cross(u_);
  start_ = t;
  searches_ = true;
}

void PegSearch::settle(double t, const Offset& now, const Vector3d& place) {
  searches_ = false;
  place_ = MinimumJerk(now.place);
  place_.correct(t, place, kSettling);
  turn_ = MinimumJerk(now.turn);
  turn_.correct(t, Vector3d::Zero(), kSettling);
}

void PegSearch::keep(double t, double was) {
  VERISIM_ASSERT(searches_);
  settle(t, at(t), at(std::max(was, start_)).place);
}

void PegSearch::clear(double t) {
  settle(t, at(t), Vector3d::Zero());
}

bool PegSearch::is_exhausted(double t) const {
  if (!searches_) return false;
  if (goal_.strategy == PegStrategy::tilt) return t - start_ > kCycle * kDirections;
  return (spiral(t).place - center_).norm() > goal_.search_radius;
}

bool PegSearch::can_find(double t) const {
  return goal_.strategy != PegStrategy::tilt || std::fmod(t - start_, kCycle) > 0.8 * kCycle;
}

PegSearch::Offset PegSearch::at(double t) const {
  if (!searches_) return {place_.place(t), turn_.place(t)};
  return goal_.strategy == PegStrategy::tilt ? tilted(t) : spiral(t);
}

/// An arc of length s reaches the angle theta with s = pitch theta^2 / 4 pi, but for the first half turn.
PegSearch::Offset PegSearch::spiral(double t) const {
  const double theta = std::sqrt(4 * pinned::kPi * goal_.search_speed * (t - start_) / goal_.pitch);
  const double r = goal_.pitch * theta / pinned::kFullTurn;
  return {center_ + r * (pinned::cos(theta) * u_ + pinned::sin(theta) * v_), Vector3d::Zero()};
}

/// Tips in the first fifth of a cycle, presses, slides in the third, erects in the fourth, presses.
PegSearch::Offset PegSearch::tilted(double t) const {
  const double cycles = std::floor((t - start_) / kCycle), x = (t - start_) / kCycle - cycles;
  const double phi = pinned::kFullTurn * kTurn * cycles;
  const Vector3d toward = pinned::cos(phi) * u_ + pinned::sin(phi) * v_;
  const double tilt = goal_.tilt * (ramp(x, 0, 0.2) - ramp(x, 0.6, 0.8));
  // The slide of one direction is taken back while the next one tips.
  const double before = pinned::kFullTurn * kTurn * (cycles - 1);
  const Vector3d last = cycles > 0 ? Vector3d(pinned::cos(before) * u_ + pinned::sin(before) * v_) : Vector3d::Zero();
  const Vector3d slid = goal_.search_radius * (ramp(x, 0.4, 0.6) * toward + (1 - ramp(x, 0, 0.2)) * last);
  // About the peg's tip: what is watched moves instead.
  return {center_ + slid + tilt * goal_.tip * toward, tilt * toward.cross(axis_)};
}

}  // namespace verisim
