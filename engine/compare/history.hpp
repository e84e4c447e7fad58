// A figure over versions: a folder of run files, or of Google Benchmark's JSON, one a version.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "engine/base/json.hpp"
#include "engine/compare/comparison.hpp"

namespace verisim::compare {

struct HistoryEntry {
  std::string file;  ///< its name in the folder
  Origin origin;
  std::map<std::string, double> figures;  ///< of runs: work counts, /summary, measures; of benchmarks: median times, ns
};

struct History {
  std::vector<HistoryEntry> entries;  ///< in the order of file names
  std::vector<std::string> figures;   ///< that are shown
};

/// Files that end in .h5 and .json; others, and hidden ones, are passed over.
/// @param figures  names to show; empty: a few
/// Error(input): no folder, none of these files in it, a figure that none of them has, with the names nearest to it.
[[nodiscard]] History read_history(const std::string& folder, const std::vector<std::string>& figures);

/// A table for each figure, with a line for each file and how far it is from the one before.
[[nodiscard]] std::string table_of(const History& history);
[[nodiscard]] Json json_of(const History& history);

}  // namespace verisim::compare
