// `verisim compare --self-test`: how often compare errs.
#pragma once

#include <string>
#include <vector>

#include "engine/base/json.hpp"
#include "engine/compare/rates.hpp"

namespace verisim::cli {

/// Runs of each build that `compare --programs` makes by default: so many are held to the promise.
inline constexpr std::size_t kJudgedRuns = 200;

struct SelfTest {
  std::string from;  ///< whose times were resampled
  std::vector<compare::Rate> rates{};
  /// False alarms of runs in turns are under 1 %, and of runs 5 % slower over 95 % are caught, both by the ends of
  /// their 95 % bounds.
  bool kept = false;
};

/// @param times_file  CSV as --programs -o writes it, or bench/baseline/times.csv; empty: the one built in
[[nodiscard]] SelfTest self_test(const std::string& times_file, bool quiet);

[[nodiscard]] std::string table_of(const SelfTest& test);
[[nodiscard]] Json json_of(const SelfTest& test);

}  // namespace verisim::cli
