// What the peers are measured by: driven insertions and contact queries, each engine under all of its settings.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/peers/peer.hpp"
#include "engine/tradeoff/table.hpp"

namespace verisim::peers {

using tradeoff::Interval;

/// How one insertion went.
struct Trial {
  Insertion task;
  bool passed = false;      ///< the pin's lower end came out below the block
  double overlap = 0;       ///< m, the deepest, from poses
  double force = 0;         ///< N, the largest contact force
  double force_error = 0;   ///< N, of the mean contact force of the last 0.1 s, against force_at_rest; if it passed
  double us = 0, us99 = 0;  ///< of a step: median, 99 %
};
[[nodiscard]] Trial run_trial(const PushSetting& setting, const Insertion& task);

/// All insertions under one setting.
struct Pushed {
  std::string text;
  std::vector<Trial> trials;
  std::vector<double> more_us;  ///< of the setting's repetitions: the median of a step, over the trials

  [[nodiscard]] int passes() const;
  /// The deepest overlap in parts of the clearance, over the trials that passed; infinite if none did.
  [[nodiscard]] double worst() const;
  [[nodiscard]] double median_us() const;                   ///< over the trials
  [[nodiscard]] std::optional<double> force_error() const;  ///< N, the greatest of trials that passed; none did: none
};

/// Contact queries at recorded poses under one setting.
struct Found {
  std::string text;
  std::vector<double> us;           ///< the median over the poses, of each round
  double us99 = 0;                  ///< over poses and rounds
  double error = 0, error95 = 0;    ///< m, of the depth, where the pin penetrates and something was found
  double gap_seen = 0;              ///< share of the clear poses of which a gap was told
  double gap_error95 = 0;           ///< m, of these
  double missed = 0, imagined = 0;  ///< share of poses: 10 um or more deep, nothing found; clear, 10 um or more found

  [[nodiscard]] Interval time() const { return tradeoff::interval_of(us); }
};

/// What is said as work goes on: how much of it is done.
using Progress = std::function<void(const std::string&)>;

/// Every setting of every engine through all tasks, task by task, so that all have the machine in turns. As `engines`.
[[nodiscard]] std::vector<std::vector<Pushed>> push_all(const std::vector<Engine>& engines,
                                                        const std::vector<Insertion>& tasks, const Progress& say);
/// The setting with most passes, of these one with the least worst(), in steps of a tenth of the clearance, of these
/// the fastest. @pre not empty
[[nodiscard]] std::size_t best_of(const std::vector<Pushed>& settings);
/// The tasks again, so many times, with each engine's best in turns: times alone.
void push_again(const std::vector<Engine>& engines, std::vector<std::vector<Pushed>>& pushed, int repeats,
                const Progress& say);

/// Poses and their analytic depths; below 0: minus the gap.
struct Poses {
  std::vector<Pose> X_AB;
  std::vector<double> depth;
  double clearance = 0;    ///< m, radial
  bool are_drawn = false;  ///< the file is not there
};
/// The poses that others were measured on (bench/peg_scene.hpp); without their file 1000 that are drawn: the pin's
/// lower end in the hole, its axis up to 7.5 mm beside the hole's and tilted by up to half a degree.
[[nodiscard]] Poses poses_in_hole();

/// Every setting of every engine at all poses, round by round. As `engines`.
[[nodiscard]] std::vector<std::vector<Found>> find_all(const std::vector<Engine>& engines, const Poses& poses,
                                                       int rounds, const Progress& say);
/// The setting that errs least often (missed or imagined, to a tenth of a percent), of these one of least error (95 %,
/// in steps of 10 um, which is what counts as seen), of these the fastest. @pre not empty
[[nodiscard]] std::size_t best_of(const std::vector<Found>& settings);

}  // namespace verisim::peers
