// A table of settings: what each costs and how wrong it is. `verisim tradeoff` makes it and writes it as tradeoff.json;
// `precision = "auto"` reads it. INTERFACES section 5 names its fields.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/json.hpp"
#include "engine/tradeoff/errors.hpp"

namespace verisim::tradeoff {

/// A median with an interval. Of repetitions: of 95 % by order statistics where there are six or more, else their
/// range.
struct Interval {
  double median = 0, low = 0, high = 0;
  double most = 0;  ///< the greatest
};
/// @pre there is a value, none is NaN
[[nodiscard]] Interval interval_of(std::vector<double> values);

/// Of an error over the repetitions: the middle one and the greatest. One more trial goes beyond the greatest of n with
/// a probability of 1 / (n + 1), whatever its distribution is: 19 repetitions bound 95 % of further trials.
struct Spread {
  double median = 0, most = 0;
};

/// Of one kind, over repetitions; `flips` as the share, which has no greatest of its own. None if a repetition has
/// none.
/// @pre there is a repetition
[[nodiscard]] std::optional<Spread> spread_of(const std::vector<Errors>& repetitions, std::size_t kind);

/// How likely a further trial stays within the greatest of so many.
[[nodiscard]] double coverage_of(std::uint64_t repetitions);

/// One repetition of a setting.
struct TrialFigures {
  std::uint64_t seed = 0;
  double time_us = 0;  ///< median frame with contact (without any: of every frame)
  Errors errors;
};

/// One setting.
struct Row {
  std::map<std::string, Json> parameters;  ///< the dials alone
  std::string failed;                      ///< why there are no figures; empty: there are
  Interval time_us;                        ///< frame with contact (without any: every frame), median of each repetition
  Interval frame_us;                       ///< every frame, likewise
  std::vector<std::pair<std::string, std::uint64_t>> cost;  ///< counter of /cost to its total over all repetitions
  std::uint64_t frames = 0;                                 ///< of all repetitions
  double step_s = 0;                                        ///< the time step
  double mean_us = 0;                                       ///< every frame, the mean
  double work_us = 0;  ///< the same as the counts alone would have it (counted_work_us)
  std::array<std::optional<Spread>, kKinds.size()> errors;
  std::optional<std::size_t> dominated;  ///< row of no more load that is not more wrong, and one of them better
  std::vector<TrialFigures> trials;      ///< of which the figures above are made; not read back from a file

  /// What it costs to simulate, us for each ms: a finer step has more frames. 1000 is real time.
  [[nodiscard]] double load() const { return step_s > 0 ? time_us.median * 1e-3 / step_s : 0; }
};

struct Table {
  std::string scenario, scenario_sha256, version, commit, cpu, compiler;
  std::uint64_t seed = 1, repeat = 1;
  std::optional<double> duration;
  std::map<std::string, Json> fixed;      ///< the scenario's other parameters
  std::string truth;                      ///< the reference setting in words
  std::string convergence;                ///< what is known of the truth's own error, in words
  std::string convergence_json = "null";  ///< the same as JSON
  Kind by = Kind::force;                  ///< the error of the front
  std::vector<std::string> notes;
  std::vector<Row> rows;
  std::string peers_json;  ///< what other engines did (peers.hpp); empty: they were not asked; not read back
};

/// Fills `dominated` of all rows, by load and by one kind of error (its greatest). Failed rows and rows without that
/// error are on no front and dominate nothing.
void find_dominated(std::vector<Row>& rows, Kind by);
/// Rows that are not dominated, the fastest first.
[[nodiscard]] std::vector<std::size_t> front_of(const std::vector<Row>& rows, Kind by);

/// Mean microseconds of a frame that the counts of /cost stand for, by weights that were measured (table.cpp says
/// where).
[[nodiscard]] double counted_work_us(const std::vector<std::pair<std::string, std::uint64_t>>& cost,
                                     std::uint64_t frames);

[[nodiscard]] Json json_of(const Table& table);
/// Error(input) that begins with `name`: no table, or a damaged one.
[[nodiscard]] Table table_from(const std::string& name, const std::string& text);
[[nodiscard]] std::string csv_of(const Table& table);
/// For people: settings by their numbers, times, errors, who dominates whom.
[[nodiscard]] std::string text_of(const Table& table);
/// "voxelsize=0.0045, hybrid=exact".
[[nodiscard]] std::string text_of(const std::map<std::string, Json>& parameters);
/// Error over load, logarithmic, the front as a line; SVG.
[[nodiscard]] std::string plot_of(const Table& table);

}  // namespace verisim::tradeoff
