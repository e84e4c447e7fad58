// How often `compare` errs: comparisons of identical programs that it calls a difference, and of a slower one that it
// does not. By resampling times that were really taken (bench/baseline/times.csv), with their drift and their bursts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/compare/series.hpp"

namespace verisim::compare {

/// Runs of one build, one after the other, in the order in which they were taken.
struct RecordedTimes {
  std::vector<SeriesFigure> figures;
  std::vector<RunTimes> runs;
};

/// Of a CSV, as --programs writes it: a line of names, then numbers; lines that begin with # are skipped. A column that
/// ends in _s is in seconds, others in ns. Error(input) with the line.
[[nodiscard]] RecordedTimes read_times(const std::string& name, const std::string& text);

/// Those that the program was built with.
[[nodiscard]] const RecordedTimes& built_in_times();

enum class Order {
  in_turns,  ///< pairs of neighbours, who is first drawn by lot: what --programs does
  apart      ///< all of A, then all of B: two files of benchmarks
};

struct RateAsked {
  Order order = Order::in_turns;
  std::size_t repetitions = 0;  ///< of A and of B in one comparison
  double slower = 0;            ///< B's times are longer by so much: 0.05 is 5 %
  std::size_t comparisons = 0;
  std::uint64_t seed = 0;  ///< of where a comparison begins in the recorded times, and of the lot
};

struct Rate {
  RateAsked asked;
  std::size_t worse = 0, better = 0, different = 0;  ///< verdicts; of all others `same`
  double seconds = 0;  ///< what one comparison takes, with the recorded runs: their median
};

/// @pre twice the repetitions are recorded
[[nodiscard]] Rate measure_rate(const RecordedTimes& recorded, const RateAsked& asked, const TimeRule& rule);

/// Clopper and Pearson's upper bound of a probability of which `count` of `trials` were seen, 95 % one-sided; and
/// lower.
[[nodiscard]] double upper_bound(std::size_t count, std::size_t trials);
[[nodiscard]] double lower_bound(std::size_t count, std::size_t trials);

}  // namespace verisim::compare
