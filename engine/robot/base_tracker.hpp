// The tracker that follows the haptic device's base (dissertation section 5.3.1: ART TrackPack4, InterSense IS-900), as
// far as its reports go: rate, latency, noise, dropouts, and axes that were swapped when it was set up.
// Floor coordinates F. SI. advance() once a millisecond; sample k is taken in the millisecond that contains k / rate.
// No allocation after construction. A report's noise depends on seed, name and its number alone.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "engine/base/random.hpp"
#include "engine/robot/mecanum.hpp"
#include "engine/robot/notes.hpp"

namespace verisim::robot {

/// Samples taken in [from, to) [s] are lost.
struct Outage {
  double from, to;
};

struct BaseTrackerSettings {
  double rate = 60;                  ///< Hz: TrackPack4. Above 0, at most 1000
  double latency = 0.020;            ///< s, from a sample until its report is there. At most 1
  double sigma_position = 0.0005;    ///< m, per axis. Set by us: optical trackers of a room reach it
  double sigma_yaw = 0.002;          ///< rad, 0.11 deg. Set by us: 0.5 mm at the rim of a target 0.25 m wide
  double dropout_rate = 0;           ///< 1/s: how often a dropout begins by chance (a camera's view is blocked)
  double dropout_mean = 0.3;         ///< s: its mean length; exponential
  std::vector<Outage> outages = {};  ///< and those that are planned
  double lost_after = 0.100;         ///< s: what is older is not valid. Above latency + 1 / rate
};

/// What is known of the base now.
struct TrackedBase {
  PlanarPose pose;        ///< as measured
  double age;             ///< s since it was measured, latency included; infinite: there was no report yet
  bool is_valid = false;  ///< age <= lost_after
  bool is_new = false;    ///< its report came in this millisecond
};

class BaseTracker {
 public:
  /// Error(input) for settings out of the ranges above.
  BaseTracker(const BaseTrackerSettings& settings, std::uint64_t seed, std::string_view name);

  /// Takes one millisecond, with the true pose in it. @pre pose is finite
  const TrackedBase& advance(const PlanarPose& pose);
  [[nodiscard]] const TrackedBase& tracked() const { return tracked_; }

  /// From now on samples are lost, as long as it is hidden.
  void hide(bool is_hidden) { is_hidden_ = is_hidden; }
  /// From now on samples have x for y and y for x; yaw stays, as where it is computed of another axis.
  void swap_axes(bool is_swapped) { is_swapped_ = is_swapped; }

  [[nodiscard]] std::uint64_t samples() const { return samples_; }  ///< taken or lost
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }  ///< of them: lost
  /// Says when the base is lost and when it is tracked (again).
  void report(RobotNotes& notes) { seen_.report(notes); }

 private:
  struct Sample {
    std::uint64_t taken, due;  ///< ms
    PlanarPose pose;
  };
  [[nodiscard]] bool is_dropped(std::uint64_t k);
  void take(const PlanarPose& pose);

  BaseTrackerSettings settings_;
  RandomStream dropouts_, lengths_, noise_x_, noise_y_, noise_yaw_;
  std::uint64_t latency_ms_;
  std::vector<Sample> under_way_;  ///< ring
  std::size_t first_ = 0, count_ = 0;
  std::uint64_t now_ = 0, samples_ = 0, dropped_ = 0, measured_at_ = 0;
  double dropout_until_ = 0;  ///< s
  bool is_swapped_ = false, is_hidden_ = false, has_report_ = false;
  TrackedBase tracked_{};
  Spell seen_{"tracker", "follows the base", "has lost the base"};
};

}  // namespace verisim::robot
