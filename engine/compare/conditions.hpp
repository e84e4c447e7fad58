// Can the times of two runs of batches be compared at all? Whoever shares a core with other runs, or prepares parts
// that lay ready for the other, is slower, and no version of the program is to blame.
#pragma once

#include <string>
#include <vector>

#include "engine/compare/index_table.hpp"

namespace verisim::compare {

/// A run of A and the same of B, as rows of their timing.csv.
struct TimedPair {
  std::size_t row_a, row_b;
};

struct ComparableTimes {
  std::vector<TimedPair> pairs;  ///< those under the same conditions
  std::string difference;        ///< of the others, "jobs 1 and 2; cache cold and warm in 3 of 40 runs"; empty: none
  bool is_known = true;          ///< false: one of them tells no conditions, and all pairs are taken
};

[[nodiscard]] ComparableTimes comparable_times(const IndexTable& a, const IndexTable& b,
                                               const std::vector<TimedPair>& pairs);

}  // namespace verisim::compare
