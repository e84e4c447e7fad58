// Motions of a head, and of the remote that watches it, on which trackers are judged. Each is a closed form of time
// with the sensor events (outages, slot exchanges) that belong to it; none depends on a tracker or a sensor setting.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/wii/set_up.hpp"

namespace verisim::wii {

struct Trajectory {
  std::string name;
  std::string what;      ///< one line for tables and help
  double duration = 10;  ///< s
  std::function<Situation(double)> at;
  std::vector<Outage> outages;
  std::vector<SlotExchange> exchanges;
  bool moves_remote = false;  ///< then it cannot be put elsewhere
  bool of_levelled = false;   ///< X_WH is X_LH: the head goes with the remote
  SetUp own = {};             ///< what a recording says of its set-up
};

/// The remote in W: at the origin of W, its lens towards +z, pitched (lens up) and rolled (its left side up), without
/// heading, so that L has the axes of W.
[[nodiscard]] Pose tilted_remote(double pitch, double roll);

/// R_LH = Rz(roll) Ry(yaw) Rx(pitch): the order that the prior of PoseSolver assumes.
[[nodiscard]] Quaterniond head_rotation(double yaw, double pitch, double roll);

/// A sum of sines: amplitude [m or rad] and frequency [Hz] of each, phase [rad].
struct Sine {
  double amplitude;
  double frequency;
  double phase;
};
[[nodiscard]] double sum_of_sines(std::span<const Sine> sines, double t);

/// A head as it was recorded before a level remote at the origin: positions linear, rotations slerp, the ends held.
/// Error(input) naming it for fewer than two samples, times that do not grow or poses that are none.
/// @pre as many poses as times
[[nodiscard]] Trajectory recorded_trajectory(const std::string& name, std::vector<double> t, std::vector<Pose> X_LH);

/// The same motion begun from the pose that belongs to `seed`: seen up to 5 degrees aside and above or below, and
/// turned so that over many seeds and all times the head is turned as far as trackers assume: by `yaw_sigma` and
/// `pitch_sigma` [rad] in the root mean square, or by as much as the motion turns it itself, where that is more.
[[nodiscard]] Trajectory from_start_pose(const Trajectory& path, double yaw_sigma, double pitch_sigma,
                                         std::uint64_t seed);

/// static, grid, sweep-x, sweep-z, far, natural, natural-yaw, edges, dropout-one, dropout-both, swap, upside-down,
/// tilted, moving-remote.
[[nodiscard]] const std::vector<Trajectory>& trajectories();
/// Error(input) for a name that is not one of them.
[[nodiscard]] const Trajectory& trajectory(std::string_view name);

}  // namespace verisim::wii
