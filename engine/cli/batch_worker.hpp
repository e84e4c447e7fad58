// What a run of a batch is: the columns that it fills, and the work of the process that computes it.
#pragma once

#include <string>

#include "engine/batch/index.hpp"
#include "engine/record/prepared_store.hpp"
#include "engine/script/parameters.hpp"
#include "engine/script/scenario.hpp"

namespace verisim::cli {

/// What all runs of a batch have in common, and what becomes of their files.
struct BatchRunOptions {
  ScenarioOptions scenario;  ///< with the sets, binds and duration of all runs
  unsigned threads = 1;
  bool measure = false;  ///< the true overlap too (engine/ruler)
  enum class Keep { summary, failed, all } keep = Keep::summary;
  std::string folder;
  std::shared_ptr<PreparedStore> store = nullptr;  ///< parts that are prepared once for all runs; null: for each anew
};

/// The columns of the index: parameters that `declared` has, figures of `verisim run --json`, costs, wall clock.
[[nodiscard]] batch::Layout layout_of_runs(const std::vector<ParameterDeclaration>& declared, bool measure);

/// Computes one run as `verisim run` does. Whatever its input does to it is the answer; Error(io) alone comes out: what
/// the disk refuses is no answer.
/// @param scenario with the run's own sets and seed
[[nodiscard]] batch::Answer answer_of_run(const BatchRunOptions& options, const ScenarioOptions& scenario,
                                          std::uint64_t run);

/// Removes what a run left in the folder, whole or not.
void remove_run_files(const BatchRunOptions& options, std::uint64_t run);

}  // namespace verisim::cli
