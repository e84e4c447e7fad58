// What several wii commands ask alike: the set-up, the motion, and what sees it.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/user_file.hpp"
#include "engine/wii/set_up.hpp"
#include "engine/wii/trajectories.hpp"

namespace verisim::cli {

/// The group in --help of all options that describe a virtual remote.
inline constexpr const char* kVirtualRemote = "Virtual remote";
/// Error(usage) if one of them was given where there is no virtual remote; `because` says what is there.
void refuse_virtual_remote(const CLI::App& command, bool seed_too, const std::string& because);

/// --leds, --fov, --remote-pose, --pixel-noise, --accelerometer-noise, --accelerometer-bits, --rate, --latency.
struct SetUpOptions {
  std::string leds;
  std::vector<double> fov;          ///< degrees
  std::vector<double> remote_pose;  ///< px … qw
  wii::SetUp rest;                  ///< the other numbers

  void add(CLI::App& command);
  /// Error(usage) or Error(input) for what is no set-up.
  [[nodiscard]] wii::SetUp set_up() const;
};

/// A motion of any trace that has poses (columns px … qw): a head's, in levelled coordinates of the remote. What its
/// header says of LEDs, field of view and remote goes with it. Adds to `opened` which file it is.
[[nodiscard]] wii::Trajectory read_motion(const std::string& file, std::vector<FileIdentity>& opened);

}  // namespace verisim::cli
