// What a run came to, in figures: the one declaration of what `--json` prints, /summary holds, the table for people is
// made of and `reproduce` reads.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace verisim {

/// A value measured by the script: measure(name, value, unit).
struct Measure {
  std::string name;
  double value;
  std::string unit;
};

/// Who answered the contacts of a pair of bodies under a hybrid method.
struct PairFigures {
  std::string first, second, hybrid;
  std::uint64_t contacts = 0, by_voxels = 0;
  std::string why;  ///< voxels answered some; empty: they did not
  [[nodiscard]] double fraction() const {
    return contacts > 0 ? static_cast<double>(by_voxels) / static_cast<double>(contacts) : 0;
  }
};

struct RunFigures {
  /// Wall clock of frames [ns], by nearest rank.
  struct Times {
    std::uint32_t p50 = 0, p99 = 0, max = 0;
  };
  std::string scenario, run_file, outcome, end, state_hash;
  std::string penetration_source;  ///< what said penetration_max: "voxels", "exact surfaces", "triangles"; or empty
  std::uint64_t frames = 0, collision_frames = 0, overruns = 0;
  std::uint64_t collisions = 0, cache_hits = 0, cache_misses = 0, null_misses = 0;
  std::uint64_t by_voxels = 0;  ///< of the collisions
  std::uint64_t exact_frames = 0, exact_frames_by_voxels = 0;
  bool realtime_priority = false;
  double simulated_s = 0, wall_s = 0, load_s = 0;
  double force_max = 0;        ///< N
  double penetration_max = 0;  ///< m
  Times frame_ns, collision_frame_ns;
  std::vector<std::pair<std::string, std::uint64_t>> constraints;  ///< name, frames in which a pair stood under it
  std::vector<PairFigures> pairs;  ///< that touched, of those for which a hybrid method was asked
  std::vector<Measure> measures;

  [[nodiscard]] double realtime_factor() const { return wall_s > 0 ? simulated_s / wall_s : 0; }
  /// A measure's value by name. Error(input) naming it if the run has none.
  [[nodiscard]] double measure(const std::string& name) const;
};

/// One of the figures above that is a number, a text or times.
struct RunFigure {
  using Value = std::variant<std::string, std::uint64_t, double, bool, RunFigures::Times>;
  const char* name;  ///< in JSON and /summary (INTERFACES section 1)
  const char* unit;
  const char* meaning;
  Value (*value)(const RunFigures&);
  bool only_once = false;  ///< no replay computes it again: wall clock, machine, where the file was
};

/// All of them but constraints, pairs and measures, whose names are the scenario's, in the order in which JSON lists
/// them.
[[nodiscard]] std::span<const RunFigure> run_figures();

}  // namespace verisim
