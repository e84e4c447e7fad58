// The aim of an operator that seeks goals in the virtual world by what it sees there, a reaction time late.
//
//   missing   what separates the watched thing from the goal, as seen
//   way       what the hand will move yet, by its own aim and by what it feels: so far ahead goes the operator's own
//             forward model (Miall et al. 1993: "Is the cerebellum a Smith predictor?"), no further
//   carried   how fast the handle moves without the hand, as in a bubble: seen motion less the hand's own
//   predicted = missing - way - carried * (reaction + kBraking): what would be missing in the end
//
// Ten times a second the aim is corrected by what is predicted to be missing, with a minimum-jerk movement whose
// duration follows Fitts' law. What resists or carries is answered otherwise: while progress is enough the hand holds
// still; where it is not the aim moves on by `push` N/s, up to the hand's greatest force. So users push on through a
// bubble's surface and against what is in the way (dissertation section 4.3.2).
//
// How far the hand has to move for that it has learned (gain); how the display is turned it sees from the handle.
#pragma once

#include "engine/device/hand.hpp"
#include "engine/device/hand/minimum_jerk.hpp"
#include "engine/device/hand/peg_search.hpp"
#include "engine/device/hand/views.hpp"

namespace verisim {

class GoalSeeker {
 public:
  /// @pre hand.goals is not empty; hand outlives this
  GoalSeeker(const HandDescription& hand, double reaction, double force_max);

  void practise(const Practice& practice) {
    practice_ = practice;
    edge_ = practice.edge;
  }
  /// One frame: sees, and moves the aim. Error(input) for a reaction time of too many frames.
  /// @param own  the hand, before this frame's step
  void advance(const DeviceFrame& frame, const Pose& own, const Wrench& felt);
  /// Where the hand wants to be, device coordinates, without tremor.
  [[nodiscard]] Pose aim() const;
  void report(DeviceNotes& notes);
  /// Counted from 1; 0: there is none left.
  [[nodiscard]] std::uint32_t goal() const {
    return goal_ < hand_.goals.size() ? static_cast<std::uint32_t>(goal_ + 1) : 0;
  }
  /// m, to where the goal seeks to be now, as it was seen.
  [[nodiscard]] double distance() const { return distance_; }

 private:
  /// What is sought now: one stretch of a goal.
  struct Leg {
    Pose to;  ///< misjudged as the operator misjudges
    bool turns = false;
    Vector3d axis = Vector3d::Zero();                        ///< unit: only what is along it counts; 0: all
    double force = std::numeric_limits<double>::infinity();  ///< N, that ends it
    double stall = std::numeric_limits<double>::infinity();  ///< s of standing still that end it
    Vector3d from = Vector3d::Zero();                        ///< m, of what is watched
    double tolerance = 0, angular_tolerance = 0, speed = 0;  ///< as in HandGoal
  };
  enum class Said : std::uint8_t { begins, beyond, reaches, gives_up };

  void see(const DeviceFrame& frame, const Pose& own, const Wrench& felt);
  void say(Said what);
  void begin_goal();
  void begin_leg(const View& view);
  void seek(const View& view);
  void end_leg(const View& view);
  void end_goal(Said said, const View& view);
  void hold(const View& view);
  void try_again();
  [[nodiscard]] bool stands(const View& view) const;
  [[nodiscard]] bool arrived(const View& view, const View& before) const;
  void decide(const View& view);
  void correct_place(const View& view);
  void steer(double speed, const Vector3d& outward, double length);
  [[nodiscard]] bool searches(const View& view, const Vector3d& lacks, bool is_resisted, const Vector3d& outward);
  void correct_rotation(const View& view);
  [[nodiscard]] bool progresses(const Vector3d& lacks) const;
  [[nodiscard]] Vector3d missing(const View& view) const;
  [[nodiscard]] double movement_time(double distance, double tolerance) const;
  void move_aim(const Vector3d& end, double T);
  void stop();
  void touch(const Vector3d& direction);
  void push(const Vector3d& direction);
  [[nodiscard]] Vector3d draw();
  [[nodiscard]] const HandGoal& wanted() const { return hand_.goals[goal_]; }

  const HandDescription& hand_;
  double reaction_, force_max_;
  Practice practice_;
  Views views_;
  std::size_t delay_ = 0, window_ = 0, patience_ = 0;  ///< frames: of the reaction, to see a velocity, to see progress
  double t_ = 0, dt_ = 0;
  MinimumJerk place_, turn_;  ///< the aim: m; rotation vector from base_
  Quaterniond base_;
  std::size_t goal_ = 0;
  Leg leg_;
  int leg_number_ = 0;  ///< of the goal
  bool goal_begun_ = false, leg_begun_ = false, is_insertion_ = false;
  double goal_start_ = 0, next_decision_ = 0, dwelling_until_ = 0;
  double distance_ = 0;
  double edge_ = std::numeric_limits<double>::infinity();  ///< m from its start: further out the handle is carried
  PegSearch search_;
  Quaterniond display_ = Quaterniond::Identity();  ///< from device coordinates to the virtual world, as seen last
  double lacked_ = 0;                              ///< m, along the axis when the search began
  double stuck_since_ = -1;                        ///< s; below 0: it is not
  Vector3d error_, angular_error_;
  std::uint32_t places_ = 0;  ///< of a wander, reached
  RandomStream stream_;
  std::uint64_t draws_ = 0;
  std::array<std::pair<Said, GoalKind>, 4> said_{};
  std::size_t said_count_ = 0;
};

}  // namespace verisim
