#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/device/sources.hpp"

namespace verisim {
namespace {

/// Physiological tremor: 8 to 12 Hz, here four sines per axis with random frequencies in that band and phases, so that
/// it is a function of time alone.
class Tremor {
 public:
  Tremor(std::uint64_t seed, const std::string& name, double rms) : amplitude_(rms * std::sqrt(2.0 / kSines)) {
    const RandomStream stream(seed, name);
    std::uint64_t counter = 0;
    for (auto& axis : waves_)
      for (Wave& wave : axis) {
        wave.omega = 2 * pinned::kPi * (8 + 4 * stream.uniform(counter++));
        wave.phase = 2 * pinned::kPi * stream.uniform(counter++);
      }
  }
  [[nodiscard]] Vector3d at(double t) const {
    if (amplitude_ == 0) return Vector3d::Zero();
    Vector3d sum = Vector3d::Zero();
    for (int axis = 0; axis < 3; ++axis)
      for (const Wave& wave : waves_[static_cast<std::size_t>(axis)])
        sum[axis] += pinned::sin(wave.omega * t + wave.phase);
    return amplitude_ * sum;
  }

 private:
  static constexpr int kSines = 4;
  struct Wave {
    double omega, phase;
  };
  double amplitude_;
  std::array<std::array<Wave, kSines>, 3> waves_{};
};

/// Duration of a leg [s]: the time that its length takes at its speed or its angle at one radian per second, the
/// longer.
double leg_duration(const Pose& from, const HandWaypoint& to) {
  const double angle = vector_from_rotation(from.rotation.conjugate() * to.pose.rotation).norm();
  return std::max((to.pose.position - from.position).norm() / to.speed, angle / 1.0);
}

class HandDevice final : public Device {
 public:
  explicit HandDevice(HandDescription description)
      : hand_(std::move(description)),
        tremor_(hand_.seed, hand_.name + " tremor", hand_.tremor),
        angular_tremor_(hand_.seed, hand_.name + " angular tremor", hand_.angular_tremor),
        retries_(hand_.seed, hand_.name + " retries"),
        error_(hand_.error),
        angular_error_(hand_.angular_error) {
    const Pose& start = hand_.path.front().pose;
    x_ = start.position + error_;
    q_ = (rotation_from_vector(angular_error_) * start.rotation).normalized();
    start_ = x_;
    reach_ = travel();
    reading_.raw = reading_.handle = {x_, q_};
  }

  [[nodiscard]] const std::string& name() const override { return hand_.name; }
  [[nodiscard]] const DeviceReading& reading() const override { return reading_; }
  [[nodiscard]] const Wrench& rendered() const override { return felt_; }
  [[nodiscard]] bool driven() const override { return true; }
  void render(const Wrench& wrench, const DeviceFrame&) override { felt_ = wrench; }
  void carry(const HandleLoad& load) override { load_ = load; }
  [[nodiscard]] std::string described() const override { return hand_.name + " (an operator)"; }

  void sample(const DeviceFrame& frame) override {
    VERISIM_ASSERT(std::isfinite(frame.t));
    VERISIM_ASSERT(frame.t >= last_t_);
    VERISIM_ASSERT(is_positive(frame.dt));
    last_t_ = frame.t;
    if (frame.number > 0) {
      walk(frame.dt);
      pull(aimed(frame.t), frame.dt);
    }
    reading_.velocity = frame.number > 0 ? velocity_between(reading_.handle, {x_, q_}, frame.dt) : Twist();
    reading_.raw = reading_.handle = {x_, q_};
  }

  [[nodiscard]] double duration() const override {
    if (hand_.repeat) return 0;
    double total = 0;
    for (std::size_t i = 0; i < hand_.path.size(); ++i)
      total += hand_.path[i].dwell + (i == 0 ? 0 : leg_duration(hand_.path[i - 1].pose, hand_.path[i]));
    return total + kSettling;
  }
  [[nodiscard]] double travel() const override {
    double farthest = 0;
    for (const HandWaypoint& w : hand_.path)
      farthest = std::max(farthest, (w.pose.position - hand_.path.front().pose.position).norm());
    // Twice the misjudgement (start and end may err oppositely), five sigma of tremor, and what contact may push it by.
    return farthest + 2 * hand_.error.norm() + 5 * hand_.tremor + kPushed;
  }

 private:
  static constexpr double kSettling = 1;   ///< s: the hand lags behind its target
  static constexpr double kPushed = 0.05;  ///< m

  /// Advances the target along the path; waits while the hand is held up, and withdraws when patience ends.
  void walk(double dt) {
    const HandWaypoint& to = hand_.path[goal_];
    if (dwelling_ > 0) {
      dwelling_ -= dt;
      return;
    }
    const Vector3d ahead = target().position + error_ - x_;
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
  void notice(bool held_up, double dt) {
    noticing_ = held_up == is_held_up_ ? 0 : noticing_ + dt;
    if (held_up == is_held_up_ || noticing_ < hand_.reaction) return;
    is_held_up_ = held_up;
    noticing_ = 0;
  }

  /// Back to the waypoint before, with the place misjudged anew.
  void retry() {
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
  Vector3d draw_signed() {
    Vector3d drawn;
    for (double& d : drawn) d = 2 * retries_.uniform(tries_++) - 1;
    return drawn;
  }

  /// How much of the leg is behind the target, in [0, 1].
  [[nodiscard]] double fraction_walked() const {
    const double duration = leg_duration(hand_.path[from_].pose, hand_.path[goal_]);
    return duration > 0 ? std::min(1.0, along_ / duration) : 1.0;
  }

  [[nodiscard]] Pose target() const {
    const Pose& a = hand_.path[from_].pose;
    if (from_ == goal_) return a;
    const double s = fraction_walked();
    const Pose& b = hand_.path[goal_].pose;
    return {a.position + s * (b.position - a.position), slerp(a.rotation, b.rotation, s)};
  }

  [[nodiscard]] Pose aimed(double t) const {
    const Pose pose = target();
    return {pose.position + error_ + tremor_.at(t),
            (rotation_from_vector(angular_error_ + angular_tremor_.at(t)) * pose.rotation).normalized()};
  }

  /// The hand's own impedance towards the aim, and what it feels. Backward Euler: stable for any stiffness and mass.
  /// The handle's friction is part of the same step: it takes what momentum there is, and never turns it round.
  void pull(const Pose& aim, double dt) {
    const HandDescription& h = hand_;
    const double mass = h.mass + load_.mass;
    Vector3d momentum = mass * v_ + dt * (h.stiffness * (aim.position - x_) + felt_.force);
    if (load_.friction > 0) {
      const double length = momentum.norm();
      momentum *= length > 0 ? std::max(0.0, 1 - dt * load_.friction / length) : 0;
    }
    v_ = momentum / (mass + dt * h.damping + dt * dt * h.stiffness);
    x_ += dt * v_;
    keep_within_reach();
    const Vector3d e = vector_from_rotation(aim.rotation * q_.conjugate());
    w_ = (h.inertia * w_ + dt * (h.angular_stiffness * e + felt_.torque)) /
         (h.inertia + dt * h.angular_damping + dt * dt * h.angular_stiffness);
    q_ = (rotation_from_vector(dt * w_) * q_).normalized();
  }

  /// travel() is a promise: whatever pushes, the arm ends there. The outward velocity is lost.
  void keep_within_reach() {
    const Vector3d out = x_ - start_;
    const double distance = out.norm();
    if (!(distance > reach_)) return;
    const Vector3d n = out / distance;
    x_ = start_ + reach_ * n;
    v_ -= std::max(0.0, v_.dot(n)) * n;
  }

  HandDescription hand_;
  Tremor tremor_, angular_tremor_;
  RandomStream retries_;
  std::uint64_t tries_ = 0;
  double last_t_ = -std::numeric_limits<double>::infinity();
  Vector3d error_, angular_error_;
  std::size_t from_ = 0, goal_ = 0;  ///< the leg that is walked
  double along_ = 0, dwelling_ = 0, waited_ = 0, noticing_ = 0;
  bool withdrawing_ = false, is_held_up_ = false;
  Vector3d x_, v_ = Vector3d::Zero(), w_ = Vector3d::Zero();
  Vector3d start_;    ///< where x_ started
  double reach_ = 0;  ///< m, travel(), computed once
  Quaterniond q_;
  DeviceReading reading_;
  Wrench felt_;
  HandleLoad load_;
};

void require(bool fine, const HandDescription& hand, const char* what) {
  if (!fine) fail(ErrorKind::input, "hand '{}': {}", hand.name, what);
}

}  // namespace

std::shared_ptr<Device> make_hand(HandDescription hand) {
  require(!hand.path.empty(), hand, "path has no waypoints; give at least one");
  for (const HandWaypoint& w : hand.path) {
    require(w.pose.position.allFinite() && w.pose.rotation.coeffs().allFinite(), hand, "a waypoint is not finite");
    require(is_unit(w.pose.rotation), hand, "a waypoint's rotation is not a unit quaternion");
    require(is_positive(w.speed), hand, "a waypoint's speed must be finite and above 0 m/s");
    require(is_not_negative(w.dwell), hand, "a waypoint's dwell must be finite and not negative");
  }
  require(is_positive(hand.mass) && is_positive(hand.inertia), hand, "mass and inertia must be finite and above 0");
  require(is_not_negative(hand.reaction), hand, "reaction must be finite and not negative");
  require(is_not_negative(hand.stiffness) && is_not_negative(hand.damping), hand,
          "stiffness and damping must not be negative");
  require(is_not_negative(hand.angular_stiffness) && is_not_negative(hand.angular_damping), hand,
          "angularStiffness and angularDamping must not be negative");
  require(is_not_negative(hand.tremor) && is_not_negative(hand.angular_tremor), hand, "tremor must not be negative");
  require(hand.lead > 0 && hand.patience > 0, hand, "lead and patience must be above 0");
  require(hand.error.allFinite() && hand.angular_error.allFinite(), hand, "error is not finite");
  return std::make_shared<HandDevice>(std::move(hand));
}

}  // namespace verisim
