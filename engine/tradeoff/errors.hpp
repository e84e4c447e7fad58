// How wrong a setting is: what it did on a hand's motion against what the truth did on the same motion.
//
// A trial with contact is chaotic: a hand that feels a newton more does something else next, and after a second two
// runs have nothing to compare. So the truth's trial is run once with its own hand; the poses of the virtual handle in
// it, after all filters, are then played to every setting, and to the truth itself, as a motion that no force changes
// (a driven motion). Wrench, pose, overlap and work are compared on that motion; `flips` alone compares whole trials in
// which the hand feels what the setting makes it feel.
//
// Wrenches are means over windows of 10 ms. A rigid contact gives impulses, whose force has no limit as the step
// becomes finer; the impulse of a window has one, and it is what a body, and a hand behind it, follows. World
// coordinates, SI; a torque is about the body's centre of mass.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/pose.hpp"

namespace verisim::tradeoff {

inline constexpr double kWindow = 0.01;  ///< s, over which a wrench is a mean

/// Means of a wrench that changes from step to step, of whatever length, over windows that begin at 0.
class WindowMeans {
 public:
  /// The wrench of the step from `begin` to `end`. A step that reaches into several windows counts in each for its
  /// part.
  /// @pre steps follow each other; 0 <= begin < end; finite
  void add(double begin, double end, const Vector6d& wrench);
  /// Of every window that has begun; the last one as if nothing came after. (windows) N, N m
  [[nodiscard]] const std::vector<Vector6d>& means() const { return means_; }

 private:
  std::vector<Vector6d> means_;
};

/// A body that moves, on the driven motion.
struct BodyMotion {
  std::string name;
  std::vector<Vector6d> wrench;  ///< of contacts on it, a mean for each window
  Pose end;                      ///< where it is at last
};

/// What a setting did on the driven motion.
struct Motion {
  std::vector<BodyMotion> bodies;  ///< in the order of the scene
  double overlap = 0;              ///< m, deepest true overlap of two bodies (engine/ruler), from poses alone
  double overlap_bound = 0;        ///< m, the true overlap is at most so much deeper
  /// J, the most that all contacts together gave over any stretch of the motion. Rigid contact without rebound gives
  /// nothing: what springs of contacts give back is counted, too.
  double work = 0;
};

/// A kind of error, declared once.
struct ErrorKindInfo {
  const char* name;
  const char* unit;
  const char* meaning;
};
enum class Kind : std::uint8_t {
  wrench,
  force,
  force_max,
  torque,
  torque_max,
  position,
  rotation,
  overlap,
  work,
  flips
};
inline constexpr std::array kKinds = {
    ErrorKindInfo{"wrench", "1", "rms of the error of the contact force by the rms of the true force"},
    ErrorKindInfo{"force", "N", "rms of the error of the contact force, over all windows of 10 ms"},
    ErrorKindInfo{"force_max", "N", "largest error of the contact force, of a window of 10 ms"},
    ErrorKindInfo{"torque", "N m", "rms of the error of the contact torque, over all windows of 10 ms"},
    ErrorKindInfo{"torque_max", "N m", "largest error of the contact torque, of a window of 10 ms"},
    ErrorKindInfo{"position", "m", "of the body that is furthest from its true place at the motion's end"},
    ErrorKindInfo{"rotation", "rad", "of the body that is turned furthest from its true orientation there"},
    ErrorKindInfo{"overlap", "m", "deepest true overlap of two bodies, by engine/ruler"},
    ErrorKindInfo{"work", "J", "the most that contacts gave over any stretch of the motion"},
    ErrorKindInfo{"flips", "1", "share of trials, the hand feeling, with another outcome than the truth's"},
};
static_assert(kKinds.size() == static_cast<std::size_t>(Kind::flips) + 1, "every kind is declared");

/// By kind; none: it cannot be said (no true force to divide by).
using Errors = std::array<std::optional<double>, kKinds.size()>;

[[nodiscard]] inline std::size_t index_of(Kind kind) {
  return static_cast<std::size_t>(kind);
}

/// Of one trial; flips is 0 or 1. Windows that one of the two lacks count as without force.
/// @pre the same bodies in the same order
[[nodiscard]] Errors errors_of(const Motion& truth, const Motion& setting, bool flipped);

/// rms of the difference of the forces of all bodies [N]. @pre as errors_of
[[nodiscard]] double force_difference(const Motion& a, const Motion& b);

/// The same run at three steps, each finer by `ratio`, and what that says of the finest: the observed order p and
/// Richardson's estimate of the finest one's own error (L. F. Richardson, Phil. Trans. A 210, 1911).
struct Convergence {
  double coarse = 0;       ///< |coarsest - middle|
  double fine = 0;         ///< |middle - finest|
  double order = 0;        ///< log(coarse / fine) / log(ratio); infinite if fine is 0
  bool converges = false;  ///< order above a half: else the differences hardly shrink, and there is no estimate
  double error = 0;        ///< fine / (ratio^order - 1); without convergence `fine`, which is then no bound
};
/// @pre differences are finite and not negative; ratio > 1
[[nodiscard]] Convergence convergence_of(double coarse, double fine, double ratio);

}  // namespace verisim::tradeoff
