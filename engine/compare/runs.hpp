// Two run files: work counts, figures of /summary, outcome, and where their states part.
#pragma once

#include <map>
#include <string>

#include "engine/compare/bounds.hpp"
#include "engine/compare/comparison.hpp"

namespace verisim {
class RunFile;
}

namespace verisim::compare {

/// Sum over all frames of each column of /cost, by its path.
[[nodiscard]] std::map<std::string, std::uint64_t> work_counts(const RunFile& file);

/// Figures of /summary, and what the scenario measured, that are numbers; times among them. Empty for a killed run.
[[nodiscard]] std::map<std::string, double> numbers_of(const RunFile& file);

[[nodiscard]] Origin origin_of(const RunFile& file, const std::string& path);

/// Error(input): not there, not a run file, a later format, runs of different scenarios. Wall clock of single runs is
/// shown and never judged. Reads both files as a whole: some 100 MB a minute of simulated time.
[[nodiscard]] Comparison compare_runs(const std::string& a, const std::string& b, const Bounds& bounds);

}  // namespace verisim::compare
