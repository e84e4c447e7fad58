// The runs of `verisim tradeoff`: a trial with its own hand, and the driven motion on which settings are compared
// (engine/tradeoff/errors.hpp says why there are two). Each is for a process of its own (engine/batch/workers.hpp), so
// what it finds goes through bytes.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/device/sources.hpp"
#include "engine/record/prepared_store.hpp"
#include "engine/script/scenario.hpp"
#include "engine/tradeoff/errors.hpp"

namespace verisim::cli {

/// A setting of a scenario's dials.
struct TrialSetting {
  ScenarioOptions scenario;  ///< with the dials' --set
  std::shared_ptr<PreparedStore> store = nullptr;
  unsigned threads = 1;
};

/// Where the virtual handle of each device was, in the order of the scene's devices.
using HandleTracks = std::vector<HapticSamples>;

/// A trial with its own hand (or --bind trace).
struct Trial {
  std::string outcome;
  double simulated_s = 0;
  std::uint64_t frames = 0;
  double frame_us = 0, contact_us = 0;  ///< medians; contact_us 0: there was none
  double mean_us = 0;                   ///< of every frame
  std::vector<std::uint64_t> cost;      ///< totals, in the order of kCostCounters
  HandleTracks tracks;                  ///< if asked for
};
/// Error(input, diverged): it cannot be run, or not to its end.
[[nodiscard]] Trial run_trial(const TrialSetting& setting, bool with_tracks);

/// The same scene with every device replaced by a recorded motion of its handle. @param simulated_s how long
[[nodiscard]] tradeoff::Motion run_driven(const TrialSetting& setting, const HandleTracks& tracks, double simulated_s);

[[nodiscard]] std::string bytes_of(const Trial& trial);
[[nodiscard]] Trial trial_from(const std::string& bytes);
[[nodiscard]] std::string bytes_of(const tradeoff::Motion& motion);
[[nodiscard]] tradeoff::Motion motion_from(const std::string& bytes);

}  // namespace verisim::cli
