#include "engine/device/hand/goal_seeker.hpp"

#include <cmath>

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim {
namespace {

// Fitts' law (1954), T = b log2(2 D / W). The slope is the order of magnitude of what is reported for a hand.
constexpr double kFittsSlope = 0.1;  // s/bit
constexpr double kShortest = 0.1;    // s, order of magnitude of the shortest correction
constexpr double kInterval = 0.1;    // s, between corrections; a choice
constexpr double kWindow = 0.1;      // s, over which a velocity is seen
constexpr double kPatience = 0.5;    // s, over which progress is judged; a choice
constexpr double kProgress = 0.05;   // of what is missing, in that time: enough; a choice
constexpr double kBraking = 0.2;     // s, that a hand needs to stop what it set going; a choice
constexpr double kArrival = 1;       // s, in which it wants to arrive where it is carried; a choice
constexpr double kFastEnough = 0.3;  // of the speed that it wants then; a choice
constexpr double kFound = 0.005;     // m deeper than when the search began: the hole is found; a choice
constexpr double kAligned = 0.9;     // cosine; a choice
constexpr double kMostLess = 0.5;    // of how far out it is, at once; a choice
constexpr double kFelt = 1;          // N, against the hand: something resists; a choice
constexpr double kInFlight = 0.1;    // of what is left of a movement: errors below that wait for its end; a choice

Quaterniond turned(const Vector3d& by, const Quaterniond& q) {
  return (rotation_from_vector(by) * q).normalized();
}

}  // namespace

GoalSeeker::GoalSeeker(const HandDescription& hand, double reaction, double force_max)
    : hand_(hand),
      reaction_(reaction),
      force_max_(force_max),
      place_(hand.start.position),
      turn_(Vector3d::Zero()),
      base_(hand.start.rotation),
      error_(hand.error),
      angular_error_(hand.angular_error),
      stream_(hand.seed, hand.name + " goals") {
  VERISIM_ASSERT(!hand.goals.empty());
}

Pose GoalSeeker::aim() const {
  const PegSearch::Offset offset = search_.at(t_);
  const Quaterniond back = display_.conjugate();
  return {place_.place(t_) + back * offset.place / practice_.gain,
          turned(back * offset.turn, turned(turn_.place(t_), base_))};
}

void GoalSeeker::see(const DeviceFrame& frame, const Pose& own, const Wrench& felt) {
  const bool body = hand_.watched == Watched::body && frame.sight.holds;
  views_.add({body ? frame.sight.body : frame.sight.handle, frame.sight.handle, own, felt.force});
}

void GoalSeeker::advance(const DeviceFrame& frame, const Pose& own, const Wrench& felt) {
  t_ = frame.t;
  if (frame.number == 0) {  // nothing has been seen yet
    dt_ = frame.dt;
    const double frames = std::floor((reaction_ + kPatience) / dt_ + 0.5);
    if (!(frames < static_cast<double>(Views::kFramesMax)))
      fail(ErrorKind::input,
           "hand '{}': a reaction time of {} s, and {} s to see progress, are {} frames; at most {} are kept",
           hand_.name, reaction_, kPatience, frames, Views::kFramesMax - 1);
    const auto in_frames = [&](double s) { return static_cast<std::size_t>(std::floor(s / dt_ + 0.5)); };
    for (const HandGoal& goal : hand_.goals)
      if (std::isfinite(goal.stall) && !(reaction_ + goal.stall < static_cast<double>(Views::kFramesMax) * dt_))
        fail(ErrorKind::input, "hand '{}': a stall of {} s behind a reaction time of {} s is more than {} frames",
             hand_.name, goal.stall, reaction_, Views::kFramesMax - 1);
    delay_ = in_frames(reaction_);
    window_ = std::max<std::size_t>(1, in_frames(kWindow));
    patience_ = std::max<std::size_t>(1, in_frames(kPatience));
    return;
  }
  see(frame, own, felt);
  if (views_.count() <= delay_) return;
  const View& view = views_.before(delay_);
  if (goal_ < hand_.goals.size() && t_ >= dwelling_until_) seek(view);
  if (t_ >= next_decision_) {
    decide(view);
    next_decision_ = t_ + kInterval;
  }
}

void GoalSeeker::seek(const View& view) {
  if (!goal_begun_) begin_goal();
  if (!leg_begun_) begin_leg(view);
  distance_ = missing(view).norm();
  if (arrived(view, views_.before(delay_ + window_)))
    end_leg(view);
  else if (t_ - goal_start_ > wanted().give_up)
    end_goal(Said::gives_up, view);
}

// --- goals and their legs -------------------------------------------------------------------------------------------

/// At most three things a frame; who does not ask for reports is not told.
void GoalSeeker::say(Said what) {
  if (said_count_ < said_.size()) said_[said_count_++] = {what, wanted().kind};
}

void GoalSeeker::begin_goal() {
  goal_begun_ = true;
  goal_start_ = t_;
  leg_number_ = 0;
  leg_begun_ = false;
  places_ = 0;
  say(Said::begins);
  const HandGoal& goal = wanted();
  const Workspace& workspace = practice_.workspace;
  const bool is_within = goal.kind == GoalKind::wander
                             ? workspace.contains(goal.box_min) && workspace.contains(goal.box_max)
                             : workspace.contains(goal.to.position);
  if (!is_within) say(Said::beyond);
}

Vector3d GoalSeeker::draw() {
  Vector3d drawn;
  for (double& d : drawn) d = stream_.uniform(draws_++);
  return drawn;
}

void GoalSeeker::begin_leg(const View& view) {
  const HandGoal& goal = wanted();
  leg_ = {{goal.to.position + error_, turned(angular_error_, goal.to.rotation)}, goal.turns};
  leg_.tolerance = goal.tolerance;
  leg_.angular_tolerance = goal.angular_tolerance;
  leg_.speed = goal.speed;
  Vector3d from = view.watched.position;
  if (goal.kind == GoalKind::insert && goal.from) {
    from = *goal.from + error_;
    if (leg_number_ == 0) leg_.to.position = from;
  }
  const bool along =
      goal.kind == GoalKind::withdraw || (goal.kind == GoalKind::insert && (leg_number_ == 1 || !goal.from));
  const Vector3d line = leg_.to.position - from;
  if (along && line.norm() > 0) leg_.axis = line.normalized();
  is_insertion_ = along && goal.kind == GoalKind::insert && line.norm() > 0;
  if (goal.kind == GoalKind::wander) leg_.to.position = goal.box_min + draw().cwiseProduct(goal.box_max - goal.box_min);
  leg_.from = view.watched.position;
  if (goal.kind == GoalKind::touch && leg_number_ == 0) {
    leg_.force = goal.force;
    leg_.stall = goal.stall;
  }
  if (goal.kind == GoalKind::touch && leg_number_ == 1) leg_.to.position = goal.retreat;
  leg_begun_ = true;
  next_decision_ = t_;
}

/// Back to before the hole, with the place misjudged anew.
void GoalSeeker::try_again() {
  search_.clear(t_);
  error_ = hand_.error.cwiseProduct(2 * draw() - Vector3d::Ones());
  angular_error_ = hand_.angular_error.cwiseProduct(2 * draw() - Vector3d::Ones());
  leg_number_ = 0;
  leg_begun_ = false;
  stuck_since_ = -1;
}

void GoalSeeker::end_leg(const View& view) {
  const HandGoal& goal = wanted();
  const bool two_legs = goal.kind == GoalKind::touch || (goal.kind == GoalKind::insert && goal.from);
  const bool is_last = goal.kind == GoalKind::wander ? ++places_ == goal.places : !two_legs || leg_number_ == 1;
  if (is_last) return end_goal(Said::reaches, view);
  hold(view);
  ++leg_number_;
  if (goal.kind != GoalKind::insert) dwelling_until_ = t_ + goal.dwell;
}

void GoalSeeker::end_goal(Said said, const View& view) {
  say(said);
  if (said == Said::reaches) dwelling_until_ = t_ + wanted().dwell;
  hold(view);
  goal_begun_ = false;
  ++goal_;
  if (goal_ == hand_.goals.size() && hand_.repeat) goal_ = 0;
}

/// Stays at a place that was reached, and where it is if it wanted to go on: a bubble would carry it away.
void GoalSeeker::hold(const View& view) {
  if (!leg_.axis.isZero(0) || missing(view).norm() > leg_.tolerance) leg_.to.position = view.watched.position;
  leg_.axis.setZero();
  is_insertion_ = leg_begun_ = false;
  search_.clear(t_);
}

Vector3d GoalSeeker::missing(const View& view) const {
  const Vector3d all = leg_.to.position - view.watched.position;
  return leg_.axis.isZero(0) ? all : Vector3d(all.dot(leg_.axis) * leg_.axis);
}

/// Has it come some way and then stood still for so long that it is up against something?
bool GoalSeeker::stands(const View& view) const {
  if (!std::isfinite(leg_.stall) || missing(view).norm() > wanted().near) return false;
  if ((view.watched.position - leg_.from).norm() <= leg_.tolerance) return false;
  const auto frames = static_cast<std::size_t>(std::floor(leg_.stall / dt_ + 0.5));
  const auto was_here = [&](std::size_t ago) {
    return (view.watched.position - views_.before(delay_ + ago).watched.position).norm() <= leg_.tolerance / 2;
  };
  return was_here(frames / 2) && was_here(frames);  // what turns round is where it was, too, but not meanwhile
}

bool GoalSeeker::arrived(const View& view, const View& before) const {
  if (view.felt_force.norm() >= leg_.force || stands(view)) return true;
  const Vector3d lacks = missing(view);
  const bool is_past = !leg_.axis.isZero(0) && lacks.dot(leg_.axis) <= 0;
  if (!is_past && lacks.norm() > leg_.tolerance) return false;
  if (leg_.turns && !is_past &&
      vector_from_rotation(leg_.to.rotation * view.watched.rotation.conjugate()).norm() > leg_.angular_tolerance)
    return false;
  // What only flies by is not there.
  return is_past || (view.watched.position - before.watched.position).norm() <= leg_.tolerance;
}

// --- how the aim moves ----------------------------------------------------------------------------------------------

double GoalSeeker::movement_time(double distance, double tolerance) const {
  const double bits = pinned::log(std::max(1.0, distance / tolerance)) / pinned::log(2.0);  // W = 2 tolerance
  return std::max(kShortest, kFittsSlope * bits);
}

void GoalSeeker::move_aim(const Vector3d& end, double T) {
  const Vector3d out = end - hand_.start.position;
  const double distance = out.norm();
  place_.correct(t_, distance > hand_.reach ? Vector3d(hand_.start.position + hand_.reach / distance * out) : end, T);
}

void GoalSeeker::stop() {
  move_aim(place_.place(t_) + kInterval / 2 * place_.velocity(t_), kInterval);
}

/// Met something on its way: keeps touch with it, no more. If that does not do it pushes, later.
void GoalSeeker::touch(const Vector3d& direction) {
  const Vector3d now = place_.place(t_);
  const double lead = (now - views_.before(0).own.position).dot(direction);
  move_aim(now + std::min(0.0, kFelt / hand_.stiffness - lead) * direction, kInterval);
}

/// Further towards `direction` (unit, device coordinates), by as much as the force may grow between two decisions.
void GoalSeeker::push(const Vector3d& direction) {
  Vector3d end = place_.end() + hand_.push * kInterval / hand_.stiffness * direction;
  const Vector3d& own = views_.before(0).own.position;  // one knows where one's hand is without looking
  const Vector3d lead = end - own;
  const double most = force_max_ / hand_.stiffness;
  if (lead.norm() > most) end = own + most / lead.norm() * lead;
  move_aim(end, kInterval);
}

bool GoalSeeker::progresses(const Vector3d& lacks) const {
  const double lacked = missing(views_.before(delay_ + patience_)).norm();
  return lacked - lacks.norm() >= std::max(leg_.tolerance / 2, kProgress * lacks.norm());
}

void GoalSeeker::decide(const View& view) {
  display_ = (view.handle.rotation * view.own.rotation.conjugate()).normalized();
  correct_place(view);
  if (leg_.turns && !search_.searches()) correct_rotation(view);
}

void GoalSeeker::correct_place(const View& view) {
  const double gain = practice_.gain;
  const auto counted = [&](const Vector3d& v) {
    return leg_.axis.isZero(0) ? v : Vector3d(v.dot(leg_.axis) * leg_.axis);
  };
  const Vector3d lacks = missing(view);
  const Vector3d own_end = place_.end() + view.felt_force / hand_.stiffness;
  const Vector3d way = counted(gain * (display_ * (own_end - view.own.position)));
  const View& before = views_.before(delay_ + window_);
  const Vector3d carried = counted(
      (view.handle.position - before.handle.position - gain * (display_ * (view.own.position - before.own.position))) /
      (static_cast<double>(window_) * dt_));
  const Vector3d predicted = lacks - way - (reaction_ + kBraking) * carried;
  const double length = lacks.norm();
  const Vector3d direction = length > 0 ? Vector3d(lacks / length) : Vector3d::Zero();
  const Vector3d outward = display_.conjugate() * direction;
  const double left = place_.left(t_);
  const double speed = carried.norm();
  // Only out there: what hardware rounds or delays looks like being carried, too.
  const bool is_out = (before.own.position - hand_.start.position).norm() > edge_ / 2;
  const bool is_carried = is_out && (reaction_ + kBraking) * speed > leg_.tolerance;
  if (is_carried && carried.dot(direction) > kAligned * speed) return steer(speed, outward, length);
  const bool is_resisted = (display_ * view.felt_force).dot(direction) < -kFelt;
  if (searches(view, lacks, is_resisted, outward)) return;
  const bool is_at_edge = (place_.end() - hand_.start.position).norm() >= edge_ * (1 - 1e-9);
  if (predicted.dot(direction) > 0 &&
      (is_resisted || (is_at_edge && (place_.end() - hand_.start.position).dot(outward) > 0))) {
    if (is_resisted && left > kInterval) return touch(outward);
    if (left <= kInterval && length > leg_.tolerance && !progresses(lacks)) push(outward);
    return;
  }
  const double on_the_way = gain * (place_.end() - place_.place(t_)).norm();
  const double bearable = left > 0 ? leg_.tolerance + kInFlight * on_the_way : leg_.tolerance / 2;
  const double off = predicted.norm();
  if (off > bearable) {
    const double T = std::max(movement_time(off, leg_.tolerance), off / leg_.speed);
    const Vector3d& home = hand_.start.position;
    const Vector3d out = place_.end() + display_.conjugate() * predicted / gain - home;
    const double farthest = std::max(edge_, (place_.end() - home).norm());  // further out only by pushing
    move_aim(home + std::min(1.0, farthest / out.norm()) * out, std::max(is_carried ? 0 : left, T));
  } else if (left == 0 && length > leg_.tolerance && !progresses(lacks)) {
    push(outward);
  }
}

/// Of an insert: what is done while the peg does not go in. True while the hand searches, which leaves the axis to it.
bool GoalSeeker::searches(const View& view, const Vector3d& lacks, bool is_resisted, const Vector3d& outward) {
  if (!is_insertion_) return false;
  const double along = lacks.dot(leg_.axis);
  if (search_.searches() && search_.can_find(t_ - reaction_) && lacked_ - along > kFound) {
    search_.keep(t_, t_ - reaction_);
    stuck_since_ = -1;
    return false;
  }
  if (!search_.searches()) {
    const bool is_stuck = is_resisted && !progresses(lacks);
    stuck_since_ = !is_stuck ? -1 : stuck_since_ < 0 ? t_ : stuck_since_;
    if (is_stuck && t_ - stuck_since_ > hand_.patience) {
      try_again();
      return true;
    }
    if (!is_stuck || wanted().strategy == PegStrategy::straight) return false;
    search_.begin(t_, wanted(), leg_.axis);
    lacked_ = along;
  }
  if (search_.is_exhausted(t_)) {
    try_again();
    return true;
  }
  const double lead = (place_.end() - view.own.position).dot(outward);
  move_aim(place_.end() + (wanted().press / hand_.stiffness - lead) * outward, kInterval);
  return true;
}

/// The handle moves without the hand, and how fast depends on how far out the hand is. It wants to arrive in kArrival:
/// too fast, it comes back towards the edge where this began; too slow, it pushes; in between it holds still.
void GoalSeeker::steer(double speed, const Vector3d& outward, double length) {
  const double wanted = length / kArrival, left = place_.left(t_);
  if (speed > wanted) {
    const Vector3d& home = hand_.start.position;
    const double out = (views_.before(0).own.position - home).norm();
    const double less = std::max(wanted / speed, kMostLess);
    move_aim(home + (std::min(out, edge_) + less * std::max(0.0, out - edge_)) * outward, kBraking);
  } else if (speed < kFastEnough * wanted) {
    if (left <= kInterval) push(outward);
  } else if (left > kInterval) {
    stop();
  }
}

void GoalSeeker::correct_rotation(const View& view) {
  const Vector3d lacks = vector_from_rotation(leg_.to.rotation * view.watched.rotation.conjugate());
  const Quaterniond end = turned(turn_.end(), base_);
  const Vector3d way = vector_from_rotation(end * view.own.rotation.conjugate());
  const Vector3d predicted = display_.conjugate() * lacks - way;
  const double left = turn_.left(t_);
  const double on_the_way = (turn_.end() - turn_.place(t_)).norm();
  const double bearable = left > 0 ? leg_.angular_tolerance + kInFlight * on_the_way : leg_.angular_tolerance / 2;
  const double off = predicted.norm();
  if (off <= bearable) return;
  const Quaterniond now = turned(turn_.place(t_), base_);
  const Quaterniond from_now = now.conjugate();
  turn_.correct_from(t_, Vector3d::Zero(), vector_from_rotation(end * from_now),
                     vector_from_rotation(turned(predicted, end) * from_now),
                     std::max(left, movement_time(off, leg_.angular_tolerance)));
  base_ = now;
}

// --- what it says ---------------------------------------------------------------------------------------------------

void GoalSeeker::report(DeviceNotes& notes) {
  static constexpr std::array kBegins = {"begins to reach", "begins to insert", "begins to withdraw",
                                         "begins to wander", "begins to touch and retreat"};
  static constexpr std::array kReaches = {"has reached its goal", "has inserted", "has withdrawn", "has wandered",
                                          "has touched and retreated"};
  static constexpr std::array kGivesUp = {"gives up reaching", "gives up inserting", "gives up withdrawing",
                                          "gives up wandering", "gives up touching and retreating"};
  static_assert(kBegins.size() == kGoalNames.size() && kReaches.size() == kGoalNames.size() &&
                kGivesUp.size() == kGoalNames.size());
  for (std::size_t i = 0; i < said_count_; ++i) {
    const auto kind = static_cast<std::size_t>(said_[i].second);
    switch (said_[i].first) {
      case Said::begins:
        notes.add("goal", kBegins[kind]);
        break;
      case Said::reaches:
        notes.add("goal", kReaches[kind]);
        break;
      case Said::gives_up:
        notes.add("goal", kGivesUp[kind]);
        break;
      case Said::beyond:
        notes.add("goal", "has a goal outside of its device's workspace");
        break;
    }
  }
  said_count_ = 0;
}

}  // namespace verisim
