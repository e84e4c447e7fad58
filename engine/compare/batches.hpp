// Two batch folders, run by run: pairs have the same parameters and the same seed.
#pragma once

#include <string>

#include "engine/compare/bounds.hpp"
#include "engine/compare/comparison.hpp"

namespace verisim::compare {

inline constexpr int kBatchFormat = 1;  ///< format_version of batch.json that is read

/// Counts are sums over the pairs, accuracy and measures their means; a pair whose outcome is another is a flip. Wall
/// clock is paired too, and judged by a wide bound: the batches were not computed in turns.
/// Error(input): no batch folder, one that has not ended, of another format or of another scenario, a damaged table, a
/// time that is none.
[[nodiscard]] Comparison compare_batches(const std::string& a, const std::string& b, const Bounds& bounds);

}  // namespace verisim::compare
