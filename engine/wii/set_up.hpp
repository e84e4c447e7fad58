// What a user, or a recording, knows better than the named sensors and trajectories: glasses, remote, imperfections.
#pragma once

#include <optional>
#include <vector>

#include "engine/wii/virtual_remote.hpp"

namespace verisim::wii {

struct Trajectory;

/// What is not given stays as the sensor, the trajectory or the tracker has it.
struct SetUp {
  std::optional<LedLayout> leds;
  std::optional<FieldOfView> fov;
  /// The remote in W, +y up. Where a motion is that of levelled coordinates only its tilt counts: the head goes with
  /// it.
  std::optional<Pose> X_WR;
  std::optional<double> pixel_noise;          ///< pixel
  std::optional<double> accelerometer_noise;  ///< g
  std::optional<int> accelerometer_bits;      ///< 0, 8 or 10
  std::optional<double> rate;                 ///< 1/s
  std::optional<double> latency;              ///< s by which a report's stamp trails what it shows
};

/// What `first` gives, and what of the rest `second` does.
[[nodiscard]] SetUp first_of(const SetUp& first, const SetUp& second);

/// The remote of a run: the sensor's imperfections or the set-up's, the glasses, the trajectory's outages and
/// exchanges.
[[nodiscard]] RemoteSettings remote_settings(const RemoteSettings& sensor, const Trajectory& path,
                                             const LedLayout& leds, const SetUp& set_up);
/// The trajectory before the set-up's remote. Error(input) for a trajectory that moves its remote.
[[nodiscard]] Trajectory placed(const Trajectory& path, const SetUp& set_up);

}  // namespace verisim::wii
