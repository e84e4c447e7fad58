// Robot{ … } that a recorded encoder trace moves: what the wheels did then, the base does again. Where the trace knows
// the true pose (motion capture), the base is there; else odometry takes it there. The tracker sees it as it sees a
// simulated one. What the haptic device wants changes nothing.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "engine/base/companion.hpp"
#include "engine/base/moving_base.hpp"
#include "engine/robot/robot.hpp"

namespace verisim::robot {

/// An encoder trace: rows in time, the first at 0.
struct EncoderSamples {
  std::vector<double> t;                      ///< s
  std::vector<std::array<double, 4>> counts;  ///< cumulative, FL FR RL RR
  std::vector<std::array<double, 3>> pose;    ///< x, y, theta; empty: not known
};

class RecordedBase final : public Companion, public MovingBase {
 public:
  /// Of the settings: name, start, device, plant.geometry, tracker, estimate, seed. The motion begins at `start`.
  /// @pre samples have rows, times ascend from 0, and everything is finite
  RecordedBase(RobotSettings settings, EncoderSamples samples);

  [[nodiscard]] const std::string& name() const override { return settings_.name; }
  /// About 0.2 us a millisecond.
  void advance(double t) override;
  [[nodiscard]] double duration() const override { return samples_.t.back(); }
  void declare(Columns& columns) const override;
  void report(PartNotes& notes) override;

  [[nodiscard]] const Pose& pose() const override { return X_WB_; }
  [[nodiscard]] const Pose& tracked_pose() const override { return tracked_X_WB_; }
  void follow(double /*error_x*/, double /*error_z*/) override {}
  void load(const Wrench& /*wrench*/) override {}
  [[nodiscard]] const Vector3d& limit() const override { return limit_; }

 private:
  [[nodiscard]] PlanarPose place_at(double t);

  RobotSettings settings_;
  EncoderSamples samples_;
  std::vector<PlanarPose> places_;  ///< of each row, F
  BaseTracker tracker_;
  BaseEstimate estimate_;
  bool is_said_ = false;    ///< that it is a recording
  std::size_t row_ = 0;     ///< the last one that has passed
  std::uint64_t done_ = 0;  ///< ms
  PlanarPose place_;
  Pose X_WB_, tracked_X_WB_;
  Vector3d limit_ = Vector3d::Zero();
};

}  // namespace verisim::robot
