// What all trackers but vrpn-compatible share: clock, gravity, admission and the rules of tracker.hpp. A tracker
// derives from this and says where the head seems to be.
#pragma once

#include "engine/wii/admission.hpp"
#include "engine/wii/gravity.hpp"
#include "engine/wii/pose_solver.hpp"
#include "engine/wii/tracker.hpp"

namespace verisim::wii {

inline constexpr double kNever = -std::numeric_limits<double>::infinity();  ///< s, of what has not happened

/// Where the head seems to be after one report.
struct Estimate {
  Pose pose;  ///< X_LH
  Matrix6d covariance = Matrix6d::Zero();
  bool usable = false;  ///< may become a valid report, if the admission rules agree
  bool known = false;   ///< pose holds an estimate, usable or not
};

class TrackerBase : public Tracker {
 public:
  explicit TrackerBase(const TrackerSettings& settings);
  using Tracker::update;
  const Report& update(double t, std::span<const double> channels, int remote) override;
  const Report& heartbeat(double t) override;

 protected:
  static constexpr int kRemotes = 2;

  /// One reading of a remote whose gravity is known. `dt` since that remote's last one (0 for the first).
  virtual void estimate(double t, double dt, const Reading& reading, int remote, Estimate& result) = 0;
  /// The estimate of this report became valid or did not.
  virtual void admitted(double t, bool valid) = 0;
  /// A new recording begins.
  virtual void restart() = 0;
  /// Whether a reading of `remote` makes a report. Stereo reports with its first remote.
  [[nodiscard]] virtual bool reports(double /*t*/, int remote) const { return remote == 0; }

  [[nodiscard]] const TrackerSettings& settings() const { return settings_; }
  [[nodiscard]] const Pinhole& pinhole() const { return pinhole_; }
  [[nodiscard]] const GravityFilter& gravity(int remote) const { return gravity_[static_cast<std::size_t>(remote)]; }
  /// The prior of a pose that is sought: yaw and pitch are near zero, give or take twice what heads turn, so that it
  /// hardly counts where they are seen.
  [[nodiscard]] Upright upright() const;
  /// Of the first remote's levelling [rad^2]: constant errors and scattered readings.
  [[nodiscard]] double tilt_variance() const {
    return settings_.gravity_sigma * settings_.gravity_sigma + gravity_[0].tilt_variance();
  }

 private:
  bool accept_time(double t, int remote, double& dt);
  void conclude(double t, Estimate& result);
  /// Whether the head seems to have turned, within `dt` since the report before, by more than heads do. An excess
  /// within 4 standard deviations is measuring noise: the turn is drawn back to what heads do.
  [[nodiscard]] bool turned_too_fast(double dt, Estimate& result) const;

  TrackerSettings settings_;
  Pinhole pinhole_;
  std::array<GravityFilter, kRemotes> gravity_;
  std::array<double, kRemotes> last_t_;
  Admission admission_;
  Report report_;
};

}  // namespace verisim::wii
