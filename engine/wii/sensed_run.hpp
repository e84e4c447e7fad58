// A whole run of the virtual Wii Remote along a trajectory, as trackers will see it, with the truth beside it.
#pragma once

#include <vector>

#include "engine/wii/trajectories.hpp"

namespace verisim::wii {

/// Where the second remote of a validation stands, in coordinates of the first: 0.5 m beside it, turned to the head.
[[nodiscard]] Pose second_remote();

struct Sensed {
  SensedReport report;
  int remote = 0;
};
/// All reports that arrive, in the order of their stamps. The truth beside each is that of its stamp; with latency the
/// channels show an earlier moment. The random streams are named after the trajectory. Error(input) for settings that
/// no virtual remote takes. @pre remotes is 1 or 2; latency is finite and not negative
[[nodiscard]] std::vector<Sensed> sense_run(const RemoteSettings& settings, const Trajectory& path, int remotes,
                                            std::uint64_t seed, double latency);

}  // namespace verisim::wii
