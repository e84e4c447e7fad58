// What the peers are measured by: driven insertions and contact queries, each engine under all of its settings.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "bench/peers/peer.hpp"

namespace verisim::peers {

/// How one insertion went.
struct Trial {
  Insertion task;
  bool passed = false;      ///< the pin's lower end came out below the block
  double overlap = 0;       ///< m, the deepest, from poses
  double force = 0;         ///< N, the largest contact force
  double us = 0, us99 = 0;  ///< of a step: median, 99 %
};

struct SettingResult {
  std::string engine, text;
  std::vector<Trial> trials;

  [[nodiscard]] int passes() const;
  /// The deepest overlap in parts of the clearance, over the trials that passed; infinite if none did.
  [[nodiscard]] double worst() const;
  [[nodiscard]] double median_us() const;  ///< over the trials
};

/// A trial of every setting, in this order: engines have the machine in turns.
[[nodiscard]] Trial run_trial(const Setting& setting, const Insertion& task);

/// Of each engine the setting with most passes, of these the one with the least worst(), of these the fastest.
[[nodiscard]] std::vector<const SettingResult*> best_of_each(const std::vector<SettingResult>& results);

/// Contact queries at recorded poses.
struct QueryResult {
  std::string engine, text;
  double us = 0, us99 = 0;        ///< over the poses
  double error = 0, error95 = 0;  ///< m, of the depth, where the pin penetrates: median, 95 %
  double missed = 0,
         imagined = 0;  ///< share of poses: 10 um or more deep, and nothing was found; and the other way round
};

/// Of the settings that differ in what they query. Empty if the recorded poses are not there.
[[nodiscard]] std::vector<QueryResult> query_all(const std::vector<Setting>& settings);

}  // namespace verisim::peers
