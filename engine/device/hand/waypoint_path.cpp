#include "engine/device/hand/waypoint_path.hpp"

#include <algorithm>

namespace verisim {
namespace {

/// Duration of a leg [s]: the time that its length takes at its speed or its angle at one radian per second, the
/// longer.
double leg_duration(const Pose& from, const HandWaypoint& to) {
  const double angle = vector_from_rotation(from.rotation.conjugate() * to.pose.rotation).norm();
  return std::max((to.pose.position - from.position).norm() / to.speed, angle / 1.0);
}

}  // namespace

WaypointPath::WaypointPath(const HandDescription& hand, double reaction)
    : hand_(hand),
      reaction_(reaction),
      retries_(hand.seed, hand.name + " retries"),
      error_(hand.error),
      angular_error_(hand.angular_error) {
  VERISIM_ASSERT(!hand.path.empty());
}

Pose WaypointPath::start() const {
  const Pose& start = hand_.path.front().pose;
  return {start.position + error_, (rotation_from_vector(angular_error_) * start.rotation).normalized()};
}

void WaypointPath::walk(const Vector3d& x, double dt) {
  const HandWaypoint& to = hand_.path[goal_];
  if (dwelling_ > 0) {
    dwelling_ -= dt;
    return;
  }
  const Vector3d ahead = target().position + error_ - x;
  const Vector3d leg = to.pose.position - hand_.path[from_].pose.position;
  // A target that comes back towards the hand need not wait.
  notice(ahead.norm() > hand_.lead && ahead.dot(leg) >= 0, dt);
  if (is_held_up_) {
    waited_ += dt;
    if (waited_ > hand_.patience && goal_ != from_) retry();
    return;
  }
  waited_ = 0;
  along_ += dt;
  if (along_ < leg_duration(hand_.path[from_].pose, to)) return;
  dwelling_ = to.dwell;
  from_ = goal_;
  along_ = 0;
  withdrawing_ = false;
  if (goal_ + 1 < hand_.path.size())
    ++goal_;
  else if (hand_.repeat)
    goal_ = 0;
}

/// That the hand is held up, or free again, is known after the reaction time.
void WaypointPath::notice(bool held_up, double dt) {
  noticing_ = held_up == is_held_up_ ? 0 : noticing_ + dt;
  if (held_up == is_held_up_ || noticing_ < reaction_) return;
  is_held_up_ = held_up;
  noticing_ = 0;
}

/// Back to the waypoint before, with the place misjudged anew.
void WaypointPath::retry() {
  const double fraction_left = 1 - fraction_walked();  // the way back may have another speed
  std::swap(from_, goal_);
  along_ = fraction_left * leg_duration(hand_.path[from_].pose, hand_.path[goal_]);
  if (!withdrawing_) {
    error_ = hand_.error.cwiseProduct(draw_signed());
    angular_error_ = hand_.angular_error.cwiseProduct(draw_signed());
  }
  withdrawing_ = !withdrawing_;
  waited_ = 0;
}

/// Three numbers in [-1, 1), drawn one after the other: the order of arguments is the compiler's.
Vector3d WaypointPath::draw_signed() {
  Vector3d drawn;
  for (double& d : drawn) d = 2 * retries_.uniform(tries_++) - 1;
  return drawn;
}

/// How much of the leg is behind the target, in [0, 1].
double WaypointPath::fraction_walked() const {
  const double duration = leg_duration(hand_.path[from_].pose, hand_.path[goal_]);
  return duration > 0 ? std::min(1.0, along_ / duration) : 1.0;
}

Pose WaypointPath::target() const {
  const Pose& a = hand_.path[from_].pose;
  if (from_ == goal_) return a;
  const double s = fraction_walked();
  const Pose& b = hand_.path[goal_].pose;
  return {a.position + s * (b.position - a.position), slerp(a.rotation, b.rotation, s)};
}

Pose WaypointPath::aim(const Vector3d& tremor, const Vector3d& angular_tremor) const {
  const Pose pose = target();
  return {pose.position + error_ + tremor,
          (rotation_from_vector(angular_error_ + angular_tremor) * pose.rotation).normalized()};
}

double WaypointPath::duration() const {
  double total = 0;
  for (std::size_t i = 0; i < hand_.path.size(); ++i)
    total += hand_.path[i].dwell + (i == 0 ? 0 : leg_duration(hand_.path[i - 1].pose, hand_.path[i]));
  return total;
}

double WaypointPath::farthest() const {
  double farthest = 0;
  for (const HandWaypoint& w : hand_.path)
    farthest = std::max(farthest, (w.pose.position - hand_.path.front().pose.position).norm());
  return farthest;
}

}  // namespace verisim
