// precision = "auto": the setting of a scenario's dials that keeps declared bounds, from a table that `verisim
// tradeoff` made (engine/tradeoff). The table is an input, so a run file holds it and a replay chooses the same;
// nothing here reads a clock or asks what machine this is.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace verisim::script {

/// What the scenario asks.
struct PrecisionRequest {
  std::string table = "tradeoff.json";           ///< beside the scenario
  std::optional<std::string> budget, error, by;  ///< as --budget, --error and --by of `verisim tradeoff`
  std::string scenario;                          ///< its name
  std::string scenario_sha256;
  std::string parameters_json;                         ///< as resolved without a choice
  std::optional<double> duration, duration_of_script;  ///< of this run; without --duration
  bool careful = false;  ///< another trial than the table's is no error: the most accurate setting, without a promise
  std::vector<std::pair<std::string, std::string>> sets;  ///< of the command line: dials that it names are not chosen
};

struct PrecisionChoice {
  std::vector<std::pair<std::string, std::string>> sets;  ///< the chosen dials, as --set takes them
  std::string event;                                      ///< what was chosen, and why
  std::vector<std::string> notices;                       ///< in what the table is not of this run
};

/// Error(input): no bound, a damaged table, one of another scenario or (unless `careful`) of another trial, whose
/// errors and times say nothing of this one; or no row that keeps the bounds (says what to do).
[[nodiscard]] PrecisionChoice choose_precision(const PrecisionRequest& request, const std::string& table_text);

}  // namespace verisim::script
