// How each figure of a run is compared: what it is, and whether more of it is worse.
#pragma once

#include <string>

#include "engine/compare/comparison.hpp"

namespace verisim::compare {

enum class FigureKind {
  skipped,  ///< says where a run stands, or nothing that has to be equal
  count,    ///< has to be equal
  hash,     ///< has to be equal, and tells nothing else
  word,     ///< outcome, status, end
  number    ///< judged by a bound: accuracy, and what a scenario measures
};

/// Of a column of index.csv: a figure of `verisim run --json`, `cost.NAME`, `constraints.NAME`, or a measure.
[[nodiscard]] FigureKind kind_of_figure(const std::string& name);

/// What it means that this count is higher, or lower. Work (`/cost`) and what was answered the expensive or the
/// imprecise way: fewer is better. How many frames and contacts there were: neither.
[[nodiscard]] Change change_of_count(const std::string& name, bool is_higher);

}  // namespace verisim::compare
