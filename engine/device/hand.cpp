#include "engine/device/hand.hpp"

#include <cmath>
#include <optional>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/device/hand/arm.hpp"
#include "engine/device/hand/goal_seeker.hpp"
#include "engine/device/hand/person.hpp"
#include "engine/device/hand/tremor.hpp"
#include "engine/device/hand/waypoint_path.hpp"

namespace verisim {
namespace {

class HandDevice final : public Device {
 public:
  explicit HandDevice(HandDescription description)
      : hand_(std::move(description)),
        tremor_(hand_.seed, hand_.name + " tremor", hand_.tremor),
        angular_tremor_(hand_.seed, hand_.name + " angular tremor", hand_.angular_tremor) {
    const double reaction = hand_.reaction.value_or(hand_.goals.empty() ? 0 : HandDescription::kReaction);
    if (hand_.goals.empty()) {
      path_.emplace(hand_, reaction);
      arm_.emplace(hand_, path_->start(), travel(), hand_.force_max.value_or(kNoLimit));
    } else {
      const double force_max = hand_.force_max.value_or(HandDescription::kForceMax);
      seeker_.emplace(hand_, reaction, force_max);
      arm_.emplace(hand_, hand_.start, travel(), force_max);
    }
    reading_.raw = reading_.handle = arm_->pose();
  }

  [[nodiscard]] const std::string& name() const override { return hand_.name; }
  [[nodiscard]] const DeviceReading& reading() const override { return reading_; }
  [[nodiscard]] const Wrench& rendered() const override { return felt_; }
  [[nodiscard]] bool driven() const override { return true; }
  void render(const Wrench& wrench, const DeviceFrame&) override { felt_ = wrench; }
  void carry(const HandleLoad& load) override { arm_->carry(load); }
  void practise(const Practice& practice) override {
    if (seeker_) seeker_->practise(practice);
    recorded_as_ = practice.name;
  }
  [[nodiscard]] std::string described() const override {
    return hand_.name + (seeker_ ? " (an operator who seeks goals)" : " (an operator)");
  }

  void sample(const DeviceFrame& frame) override {
    VERISIM_ASSERT(std::isfinite(frame.t));
    VERISIM_ASSERT(frame.t >= last_t_);
    VERISIM_ASSERT(is_positive(frame.dt));
    last_t_ = frame.t;
    if (seeker_) seeker_->advance(frame, arm_->pose(), felt_);
    if (frame.number > 0) {
      if (path_) path_->walk(arm_->position(), frame.dt);
      arm_->pull(aim(frame.t), felt_, frame.dt);
    }
    reading_.velocity = frame.number > 0 ? velocity_between(reading_.handle, arm_->pose(), frame.dt) : Twist();
    reading_.raw = reading_.handle = arm_->pose();
  }

  [[nodiscard]] double duration() const override {
    if (hand_.repeat || !path_) return 0;
    return path_->duration() + kSettling;
  }
  [[nodiscard]] double travel() const override {
    // Twice the misjudgement (start and end may err oppositely), five sigma of tremor, and what contact may push it by.
    if (path_) return path_->farthest() + 2 * hand_.error.norm() + 5 * hand_.tremor + kPushed;
    return hand_.reach + 5 * hand_.tremor + kPushed;
  }

  void declare(Columns& columns) const override {
    if (!seeker_) return;
    const std::string path = "/state/device/" + (recorded_as_.empty() ? name() : recorded_as_);
    columns.add(path + "/goal", "1", "the goal that the operator seeks, counted from 1; 0: none is left",
                [this] { return seeker_->goal(); });
    columns.add(path + "/distance", "m", "what is missing to it, as the operator saw it last",
                [this] { return seeker_->distance(); });
  }
  void report(DeviceNotes& notes) override {
    if (seeker_) seeker_->report(notes);
  }

 private:
  static constexpr double kSettling = 1;   ///< s: the hand lags behind its target
  static constexpr double kPushed = 0.05;  ///< m
  static constexpr double kNoLimit = std::numeric_limits<double>::infinity();

  [[nodiscard]] Pose aim(double t) const {
    if (path_) return path_->aim(tremor_.at(t), angular_tremor_.at(t));
    const Pose pose = seeker_->aim();
    return {pose.position + tremor_.at(t), (rotation_from_vector(angular_tremor_.at(t)) * pose.rotation).normalized()};
  }

  HandDescription hand_;
  Tremor tremor_, angular_tremor_;
  std::optional<WaypointPath> path_;  ///< or
  std::optional<GoalSeeker> seeker_;
  std::optional<Arm> arm_;
  std::string recorded_as_;
  double last_t_ = -std::numeric_limits<double>::infinity();
  DeviceReading reading_;
  Wrench felt_;
};

void require(bool fine, const HandDescription& hand, const char* what) {
  if (!fine) fail(ErrorKind::input, "hand '{}': {}", hand.name, what);
}

void check_path(const HandDescription& hand) {
  for (const HandWaypoint& w : hand.path) {
    require(w.pose.position.allFinite() && w.pose.rotation.coeffs().allFinite(), hand, "a waypoint is not finite");
    require(is_unit(w.pose.rotation), hand, "a waypoint's rotation is not a unit quaternion");
    require(is_positive(w.speed), hand, "a waypoint's speed must be finite and above 0 m/s");
    require(is_not_negative(w.dwell), hand, "a waypoint's dwell must be finite and not negative");
  }
}

void check_goals(const HandDescription& hand) {
  require(is_placement(hand.start), hand, "start is not finite with a unit quaternion");
  require(is_positive(hand.reach), hand, "reach must be finite and above 0 m");
  require(is_positive(hand.push), hand, "push must be finite and above 0 N/s");
  require(is_positive(hand.stiffness), hand, "a hand with goals needs a stiffness above 0");
  for (const HandGoal& goal : hand.goals) {
    require(is_placement(goal.to), hand, "a goal's place is not finite with a unit quaternion");
    require(!goal.from || goal.from->allFinite(), hand, "a goal's from is not finite");
    require(goal.retreat.allFinite(), hand, "a goal's retreat is not finite");
    require(goal.box_min.allFinite() && goal.box_max.allFinite(), hand, "a goal's box is not finite");
    require((goal.box_max - goal.box_min).minCoeff() >= 0, hand, "a goal's box ends before it begins");
    require(is_positive(goal.tolerance) && is_positive(goal.angular_tolerance), hand,
            "a goal's tolerance and angularTolerance must be finite and above 0");
    require(is_positive(goal.force), hand, "a goal's force must be finite and above 0 N");
    require(goal.speed > 0, hand, "a goal's speed must be above 0 m/s");
    require(is_not_negative(goal.dwell), hand, "a goal's dwell must be finite and not negative");
    require(is_positive(goal.pitch) && is_positive(goal.search_speed) && is_positive(goal.search_radius), hand,
            "a goal's pitch, searchSpeed and searchRadius must be finite and above 0");
    require(is_positive(goal.tilt) && goal.tilt < 1 && is_not_negative(goal.tip) && is_positive(goal.press), hand,
            "a goal's tilt must be above 0 and below 1 rad, its tip not negative, its press above 0 N");
    require(is_positive(goal.give_up), hand, "a goal's giveUp must be finite and above 0 s");
  }
}

}  // namespace

std::shared_ptr<Device> make_hand(HandDescription hand) {
  require(hand.path.empty() || hand.goals.empty(), hand, "it has both a path and goals; give one of them");
  require(!hand.path.empty() || !hand.goals.empty(), hand,
          "path has no waypoints; give at least one, or goals in its place");
  check_path(hand);
  if (!hand.goals.empty()) check_goals(hand);
  require(is_positive(hand.mass) && is_positive(hand.inertia), hand, "mass and inertia must be finite and above 0");
  require(!hand.force_max || is_positive(*hand.force_max), hand, "the greatest force must be finite and above 0 N");
  require(!hand.reaction || is_not_negative(*hand.reaction), hand, "reaction must be finite and not negative");
  require(is_not_negative(hand.stiffness) && is_not_negative(hand.damping), hand,
          "stiffness and damping must not be negative");
  require(is_not_negative(hand.angular_stiffness) && is_not_negative(hand.angular_damping), hand,
          "angularStiffness and angularDamping must not be negative");
  require(is_not_negative(hand.tremor) && is_not_negative(hand.angular_tremor), hand, "tremor must not be negative");
  require(hand.lead > 0 && hand.patience > 0, hand, "lead and patience must be above 0");
  require(hand.error.allFinite() && hand.angular_error.allFinite(), hand, "error is not finite");
  become(hand);
  return std::make_shared<HandDevice>(std::move(hand));
}

}  // namespace verisim
