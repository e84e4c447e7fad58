// The sweep of `verisim tradeoff`: every setting run and judged, repetition by repetition.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/batch/design.hpp"
#include "engine/batch/workers.hpp"
#include "engine/cli/tradeoff_runs.hpp"
#include "engine/script/parameters.hpp"
#include "engine/session/progress_line.hpp"
#include "engine/tradeoff/table.hpp"

namespace verisim::cli {

struct SweepRequest {
  std::string scenario;
  std::vector<std::string> vary, truth, sets, binds;  ///< KEY=…
  std::optional<double> duration, time_limit_s;
  std::uint64_t memory_limit_mb = 0;  ///< 0: 80 % of the machine's
  std::uint64_t seed = 1, repeat = 3;
  unsigned threads = 1;  ///< of each run
  bool no_cache = false, quiet = false;
};

/// A setting that cannot be run is a row that says why; a truth that cannot be run is an error.
class Sweep {
 public:
  /// Reads scenario and dials. Error(usage): no dial, one setting only, a value twice; Error(input): no such parameter.
  explicit Sweep(const SweepRequest& request);
  /// Runs everything: of each repetition the truth, then all settings in an order drawn by lot, one at a time, so that
  /// no drift of the machine is always on one of them. Error(input): the truth fails. Error(interrupted).
  [[nodiscard]] tradeoff::Table table(tradeoff::Kind by);

 private:
  struct Repetition;
  struct Measured;
  struct StepStudy;
  [[nodiscard]] TrialSetting setting_of(std::size_t setting, std::uint64_t repetition) const;
  [[nodiscard]] TrialSetting truth_of(std::uint64_t repetition, double step_scale) const;
  void make_truth();
  [[nodiscard]] std::string truth_text() const;
  void say_what_is_not_reached();
  void say_what_the_truth_has_of_its_own();
  void say_where_truth_is_not_finer(const std::map<std::string, batch::Cell>& truth);
  /// Computes it in a process of its own. Error(input) with the reason if that gave no answer.
  [[nodiscard]] std::string in_a_process(const std::function<std::string()>& work);
  [[nodiscard]] Repetition run_truth(std::uint64_t repetition);
  void run_setting(std::size_t setting, const Repetition& repetition, Measured& measured);
  [[nodiscard]] StepStudy study_step(const Repetition& repetition);
  static void tell_convergence(const std::vector<StepStudy>& studies, tradeoff::Table& table);
  [[nodiscard]] tradeoff::Row row_of(std::size_t setting, const Measured& measured) const;
  void say_progress();

  SweepRequest request_;
  ScenarioOptions scenario_;  ///< of all runs
  std::shared_ptr<PreparedStore> store_;
  std::string scenario_sha256_;
  std::vector<ParameterDeclaration> declared_;
  batch::Design design_;
  std::vector<std::pair<std::string, std::string>> truth_sets_;
  double truth_step_scale_ = 1;
  batch::WorkerLimits limits_;
  std::vector<std::string> notes_;
  std::unique_ptr<ProgressLine> line_;
  std::uint64_t runs_done_ = 0;
};

}  // namespace verisim::cli
