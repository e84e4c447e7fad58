// One figure that the dissertation reports beside the same figure measured here, and the means of a measurement.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "engine/base/run_figures.hpp"

namespace verisim::reproduce {

/// A number, or words where the result is none (R9: "does not assemble").
using Figure = std::variant<double, std::string>;

/// One line of the table. A result with several figures (an area and a volume) gives several rows with one id.
struct Row {
  std::string id;    ///< R1 ..., as ORACLES numbers them
  std::string what;  ///< the figure, with its unit in `unit`
  std::string unit;  ///< empty: a pure number or words
  Figure published;
  Figure here;
  std::optional<std::pair<double, double>> interval;  ///< 95 % confidence interval of `here`
  std::string why;                                    ///< reason if `here` differs from `published`
  std::vector<std::string> runs;                      ///< run files of this measurement from which `here` was computed
};

/// here / published; none unless both are numbers and published is not 0.
[[nodiscard]] std::optional<double> ratio(const Row& row);

/// One run of a scenario, as `verisim run` makes it.
struct RunRequest {
  std::string scenario;                                     ///< of the folder `scenarios`: "peg_in_hole"
  std::string file;                                         ///< run file to write
  std::vector<std::pair<std::string, std::string>> sets{};  ///< parameters, as --set
  std::optional<double> duration{};                         ///< s
  std::optional<std::uint64_t> seed{};
  bool paced = false;             ///< by the wall clock
  std::uint64_t empty_block = 0;  ///< paced: length of the empty blocks between blocks of frames; see LoopOptions
};
/// What came of it: the figures of every run, and the times and overruns that they were made of.
struct TimedRun : RunFigures {
  std::vector<std::uint32_t> frame_times_ns;                        ///< of every frame
  std::vector<std::uint32_t> collision_frame_times_ns;              ///< of the frames with contact
  std::vector<std::uint32_t> block_overruns, empty_block_overruns;  ///< of each block, and of the empty one after it
};

/// The means of a measurement.
struct Workshop {
  bool quick = false;  ///< all results together in under 45 s on two cores
  std::string folder;  ///< exists; every file of a measurement goes here
  std::function<TimedRun(const RunRequest&)> run;
  bool force = false;  ///< replace files of other kinds as well

  /// The path of a file in `folder`.
  [[nodiscard]] std::string file(const std::string& name) const { return folder + "/" + name; }
};

}  // namespace verisim::reproduce
