// Robot{ … } of a scene: the mobile base of dissertation chapter 5 as a whole, beside the loop: tracker, robot server,
// serial line, board with its firmware, motors, wheels and floor. It carries a haptic device and is driven by it.
//
// One millisecond, in this order:
//   tracker -> drive law, walls -> server -> line -> board -> plant -> edges of the encoders for the next one
// A frame that is longer holds several of them, one that is shorter none; what stands on the base in the meantime is
// carried on by the velocity that it has.
//
// Coordinates. World W: y up. Floor F: x as the world's, y as its -z, heading counter-clockwise seen from above. Robot
// R: x forward, y left. Base B: the device's, as it is bolted to the robot: x along R's x, y up, z along R's -y. SI.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "engine/base/companion.hpp"
#include "engine/base/moving_base.hpp"
#include "engine/robot/base_estimate.hpp"
#include "engine/robot/base_tracker.hpp"
#include "engine/robot/clock.hpp"
#include "engine/robot/odometry.hpp"
#include "engine/robot/pilot.hpp"
#include "engine/robot/plant.hpp"
#include "engine/robot/serial_line.hpp"
#include "firmware_sim/board.hpp"

namespace verisim::robot {

/// X_WB of a device at p_RB on a robot whose wheels' middle is at `pose`; the floor is the world's y = 0.
[[nodiscard]] Pose base_in_world(const PlanarPose& pose, const Vector3d& p_RB);

struct RobotSettings {
  std::string name = "robot";
  PlanarPose start;             ///< of the middle of the wheels, F
  Vector3d device{0, 0, 0.80};  ///< p_RB, m: where the device is bolted to its stand; a working height, estimated
  PlantParameters plant;
  PilotSettings pilot;      ///< server, drive law and walls; the neutral place is the device's filter's
  SerialLineSettings line;  ///< both directions; `baud` is the host's, receiver_baud the board's own
  BaseTrackerSettings tracker;
  EstimateParameters estimate;  ///< of where the base is now, of the tracker's reports
  std::uint64_t seed = 1;
};

class Robot final : public Companion, public MovingBase {
 public:
  /// Error(input) for settings out of their ranges. @pre board is not null
  Robot(RobotSettings settings, std::unique_ptr<firmware::Board> board);

  // Companion
  [[nodiscard]] const std::string& name() const override { return settings_.name; }
  /// About 4 us a millisecond with the host board.
  void advance(double t) override;
  [[nodiscard]] double duration() const override { return 0; }
  /// /state/robot/NAME and /cost/robot/NAME.
  void declare(Columns& columns) const override;
  void report(PartNotes& notes) override;

  // MovingBase
  [[nodiscard]] const Pose& pose() const override { return X_WB_; }
  [[nodiscard]] const Pose& tracked_pose() const override { return tracked_X_WB_; }
  void follow(double error_x, double error_z) override;
  void load(const Wrench& wrench) override;
  [[nodiscard]] const Vector3d& limit() const override { return limit_B_; }

  /// Where the person's head is, F [m]; empty: nobody knows. For a base that keeps out of the line of sight.
  void watch(std::function<std::optional<std::array<double, 2>>()> head) { head_ = std::move(head); }

  // What a script may do to it between frames: faults, and what an operator does at the console.
  [[nodiscard]] Pilot& pilot() { return pilot_; }
  [[nodiscard]] Plant& plant() { return plant_; }
  [[nodiscard]] BaseTracker& tracker() { return tracker_; }
  void unplug(bool is_unplugged);
  void reset_board() { board_->reset(); }
  void set_powered(bool on);  ///< board and motors
  [[nodiscard]] const PlanarPose& place() const { return plant_.state().pose; }

 private:
  void millisecond();
  void take_load();
  void hear_tracker();
  void place_device(double t);

  RobotSettings settings_;
  std::unique_ptr<firmware::Board> board_;
  Plant plant_;
  SerialLine down_, up_;  ///< to the robot, from it
  BaseTracker tracker_;
  BaseEstimate estimate_;
  Pilot pilot_;
  SlipDetector slip_;
  std::function<std::optional<std::array<double, 2>>()> head_;
  std::uint64_t done_ = 0;                    ///< ms
  std::vector<firmware::EncoderEdge> edges_;  ///< of the last millisecond
  std::array<double, 2> error_D_{};           ///< m
  Wrench load_B_;                             ///< summed over the frames since the last millisecond
  std::uint32_t loads_ = 0;                   ///< frames
  Reaction reaction_;                         ///< their mean
  Pose X_WB_, tracked_X_WB_;
  Vector3d limit_B_ = Vector3d::Zero();
  Spell slipping_{"robot", "slips: its wheels turn as no motion of the base turns them", "rolls again"};
};

}  // namespace verisim::robot
