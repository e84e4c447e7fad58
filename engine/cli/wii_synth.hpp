// `verisim trace synth wii`, and the runs of the virtual remote that other commands judge by.
#pragma once

#include <string>
#include <vector>

#include "engine/base/user_file.hpp"
#include "engine/cli/wii_set_up.hpp"
#include "engine/record/trace.hpp"
#include "engine/wii/sensed_run.hpp"

namespace verisim::cli {

/// Which head is seen by which remote.
struct VirtualRunOptions {
  std::string trajectory = "natural";
  std::string motion;  ///< file, in place of the trajectory
  std::string sensor = "wiimote";
  SetUpOptions set_up;
  std::uint64_t seed = 1;

  /// --trajectory, --motion, --sensor and the set-up. (--seed is the command's.)
  void add(CLI::App& command);
};

struct VirtualRun {
  std::string trajectory, sensor;
  std::vector<wii::SensedReport> samples;  ///< as `wii validate` of the same names and seed senses them
  wii::SetUp set_up;                       ///< as far as it was not the sensor's
  wii::TrackerSettings settings;           ///< glasses and field of view
  double rate = 0;                         ///< 1/s
};
/// Error(usage) or Error(input) for what is not known or no set-up. Adds to `opened` which files were read.
[[nodiscard]] VirtualRun run_virtually(const VirtualRunOptions& options, std::vector<FileIdentity>& opened);

/// The run as a wii trace with true poses.
[[nodiscard]] Trace wii_trace_of(const VirtualRun& run, const std::string& source);

}  // namespace verisim::cli
