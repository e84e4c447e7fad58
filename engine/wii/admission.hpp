// The last gate before a report is called valid: distance, speed, confirmation of jumps.
#pragma once

#include "engine/base/pose.hpp"
#include "engine/wii/thresholds.hpp"

namespace verisim::wii {

// Limits of the task, promised by tracker.hpp: no heuristics.
inline constexpr double kDistanceMin = 0.2;  ///< m
inline constexpr double kDistanceMax = 5;    ///< m
inline constexpr double kSpeedMax = 5;       ///< m/s: heads are slower
inline constexpr double kSilenceMax = 0.5;   ///< s: after that nothing is known of where the head went

/// A limit kept in exact arithmetic would be missed by a rounding in a reader's check: stay a little below it.
inline constexpr double kWithin = 0.999;

/// Decides on one candidate position after another. Constant time and size.
class Admission {
 public:
  enum class Verdict { refused, continued, elsewhere };
  explicit Admission(double slack_sigmas = Thresholds().slack_sigmas) : slack_sigmas_(slack_sigmas) {}

  /// `p_L` may be used as it comes (continued), is drawn back to what kSpeedMax allows since the last admitted one
  /// (continued; when the excess is within 4 standard deviations, measuring noise and not a jump), has jumped but is
  /// the second in a row at the new place (elsewhere), or is refused. The first one, and the first after kSilenceMax,
  /// is elsewhere.
  /// Times may go back a little, where two remotes report whose clocks differ: what counts is how far apart they are.
  /// @pre t is finite
  [[nodiscard]] Verdict judge(double t, double variance, Vector3d& p_L);
  void forget() { *this = Admission(slack_sigmas_); }

 private:
  struct Place {
    bool set = false;
    double t = 0;
    Vector3d p_L = Vector3d::Zero();
  };
  [[nodiscard]] bool reachable(const Place& from, double t, double variance, const Vector3d& p_L) const;

  double slack_sigmas_;
  Place last_;       ///< admitted
  Place candidate_;  ///< refused as a jump, waits for a second one
};

}  // namespace verisim::wii
