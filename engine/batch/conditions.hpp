// What the times of a run hang on beside the program and what it was asked: columns of the table `timing`. They are of
// each run, not of the batch: shards, interruptions and retries have their own.
#pragma once

#include <string>
#include <vector>

#include "engine/base/json.hpp"
#include "engine/batch/index.hpp"

namespace verisim::batch {

/// Of one call of the program.
struct Conditions {
  unsigned jobs = 1;  ///< runs at the same time
  unsigned threads = 1, cores = 1;
  bool recorded = false;  ///< run files were written
  std::string simd, cpu;
};

/// Their columns, and `cache`: what the run itself says of its prepared parts.
[[nodiscard]] std::vector<IndexColumn> condition_columns();
void add_conditions(Answer& answer, const Conditions& conditions);

/// For batch.json: a member for each set of conditions, in the order of its first run, with the number of its `runs`.
[[nodiscard]] Json conditions_json(Index& index);

}  // namespace verisim::batch
