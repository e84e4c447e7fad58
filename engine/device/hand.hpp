// Devices.Hand{ ... }: a modelled operator. A point mass and inertia (the hand with the handle) is pulled by an
// impedance (spring and damper, its own muscles) towards an aim with tremor, and feels the rendered wrench. The aim
// follows a path in the device's coordinates, or seeks goals in the virtual world by what the operator sees there.
//
//   path   a list of waypoints; what the operator sees does not matter (hand/waypoint_path.hpp)
//   goals  places of the virtual handle, or of the body that it holds; minimum-jerk movements that are corrected by
//   what
//          is seen, a reaction time late, and pushing where nothing moves (hand/goal_seeker.hpp)
//
// Sources: Flash & Hogan 1985 (J. Neurosci. 5:1688): minimum jerk. Fitts 1954: duration. Dissertation section 4.3.2:
// users push on, through the bubble, as long as what they want does not come.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/random.hpp"
#include "engine/device/device.hpp"

namespace verisim {

/// One leg of an operator's target path.
struct HandWaypoint {
  Pose pose;           ///< target of the hand, device coordinates
  double speed = 0.1;  ///< m/s along the leg that ends here
  double dwell = 0;    ///< s, waits after arriving
};

enum class GoalKind {
  reach,     ///< to a place
  insert,    ///< to `from`, then along the line to a place; how far it comes along the line counts
  withdraw,  ///< along the line from where it is to a place
  wander,    ///< from one place in a box to the next
  touch      ///< towards a place until a force is felt or the place is reached, then to `retreat`
};
inline constexpr std::array kGoalNames = {"reach", "insert", "withdraw", "wander", "touch and retreat"};

/// What the operator brings to the goal.
enum class Watched { handle, body };  ///< body: of what is held; the handle while nothing is
inline constexpr std::array kWatchedNames = {"handle", "body"};

/// What an operator does with a peg that does not go in (hand/peg_search.hpp).
enum class PegStrategy { straight, tilt, spiral };
inline constexpr std::array kPegStrategyNames = {"straight", "tilt", "spiral"};

/// What a hand wants. Places are the virtual world's, not the hardware's: behind a scale or in a bubble they differ.
struct HandGoal {
  GoalKind kind = GoalKind::reach;
  Pose to;                       ///< m; of a wander not used
  bool turns = false;            ///< does the orientation of `to` count? Else the hand turns nothing
  std::optional<Vector3d> from;  ///< m, of an insert; none: from where it is
  Vector3d box_min = Vector3d::Zero(), box_max = Vector3d::Zero();  ///< m, of a wander
  std::uint32_t places = 0;                                         ///< of a wander; 0: no end
  Vector3d retreat = Vector3d::Zero();                              ///< m, of a touch
  double force = 2;                                                 ///< N, of a touch: felt at the hand
  /// s, of a touch: standing still for so long, as seen, within `near` (m) of the place it has touched; infinity: only
  /// force or place tell.
  double stall = std::numeric_limits<double>::infinity();
  double near = std::numeric_limits<double>::infinity();
  double tolerance = 0.005;                                ///< m: so near is there
  double angular_tolerance = 0.05;                         ///< rad
  double speed = std::numeric_limits<double>::infinity();  ///< m/s in the virtual world, mean of a movement, at most
  double dwell = 0;                                        ///< s, at the goal
  double give_up = 30;                                     ///< s, after which it goes on to the next goal
  PegStrategy strategy = PegStrategy::straight;            ///< of an insert
  double pitch = 0.004;                                    ///< m, of the spiral; at most twice the clearance
  double search_speed = 0.02;                              ///< m/s, along the spiral; a choice
  double search_radius = 0.02;                             ///< m, of the spiral; how far a tilted peg slides
  double tilt = 0.15;                                      ///< rad; a choice
  double tip = 0;                                          ///< m, from what is watched to the peg's tip
  double press = 2;  ///< N at the hand, along the axis, while it searches; a choice
};

/// Where mass, damping and stiffness come from (hand/person.hpp).
enum class ArmKind {
  given,     ///< the fields of the description
  measured,  ///< of one person
  drawn      ///< another person for each seed
};
inline constexpr std::array kArmNames = {"given", "measured", "drawn"};

struct HandDescription {
  std::string name = "hand";
  std::vector<HandWaypoint> path;  ///< or goals
  std::vector<HandGoal> goals;     ///< one after the other
  Pose start;                      ///< of a hand with goals, device coordinates
  Watched watched = Watched::handle;
  bool repeat = false;  ///< after the last waypoint or goal on to the first, until the run ends
  ArmKind arm = ArmKind::given;
  double mass = 0.15;               ///< kg, fingers and handle
  double inertia = 1e-3;            ///< kg m^2
  double stiffness = 400;           ///< N/m
  double damping = 15.5;            ///< N s/m (2 sqrt(k m))
  double angular_stiffness = 2;     ///< N m/rad
  double angular_damping = 0.0894;  ///< N m s/rad (2 sqrt(k I))
  /// N, the greatest force of the muscles; none: no limit on a path, kForceMax with goals.
  std::optional<double> force_max;
  static constexpr double kForceMax = 20;  ///< N, order of magnitude of what a user of a desktop device applies
  /// m, how far a hand with goals gets from where it starts. Order of magnitude of an arm.
  double reach = 0.6;
  double push = 10;  ///< N/s, how fast a hand with goals pushes harder while nothing moves; a choice
  double lead = std::numeric_limits<double>::infinity();  ///< m; the target waits while it is further ahead of the hand
  double patience =
      std::numeric_limits<double>::infinity();  ///< s; after so long a wait back to the waypoint before, and again
  /// s, until the hand knows that it is held up, or no longer; with goals also until it sees what is. None: 0 on a
  /// path, kReaction with goals.
  std::optional<double> reaction;
  static constexpr double kReaction = 0.2;    ///< s, order of magnitude of a reaction to what is seen
  double tremor = 0;                          ///< m rms, 8 to 12 Hz, each axis
  double angular_tremor = 0;                  ///< rad rms
  Vector3d error = Vector3d::Zero();          ///< m, added to every target: misjudged place
  Vector3d angular_error = Vector3d::Zero();  ///< rad, rotation vector
  std::uint64_t seed = 1;
};

/// On a path it does not push blindly: `lead` bounds how far the target runs ahead of a hand that is held up, and after
/// `patience` it withdraws to the waypoint before and tries again with newly misjudged `error` (drawn uniformly within
/// +-error per axis; the first try uses `error` itself). Its duration() is that of an operator whom nothing holds up.
/// With goals it has no duration. It says when it begins, reaches and gives up a goal, and records which goal it seeks
/// and how far it is (`goal`, `distance`).
/// It never gets further than travel(). Error(input) for a path without waypoints, for both path and goals, and for
/// values that are not finite, negative or, where the model divides by them, zero.
[[nodiscard]] std::shared_ptr<Device> make_hand(HandDescription description);

}  // namespace verisim
