#include "engine/script/precision.hpp"
#include "engine/base/json.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/error.hpp"
#include "engine/base/text.hpp"
#include "engine/tradeoff/bounds.hpp"

namespace verisim::script {
namespace {

using tradeoff::Row;
using tradeoff::Table;

/// As --set takes it; true and false are texts in a table.
std::string set_text(const Json& value) {
  return value.is_string() ? value.get<std::string>() : json_text(value);
}

bool is_same(const Json& a, const Json& b) {
  if (a.is_number() && b.is_number()) return a.get<double>() == b.get<double>();
  return set_text(a) == set_text(b);
}

tradeoff::Bounds bounds_of(const PrecisionRequest& request, tradeoff::Kind& by) {
  tradeoff::Bounds bounds;
  if (request.by) by = tradeoff::kind_named("by", *request.by);
  if (request.budget) bounds.budget_us = tradeoff::budget_from("budget", *request.budget);
  if (request.error) {
    bounds.error = tradeoff::error_bound_from("error", *request.error, request.by.value_or(""));
    by = bounds.error->kind;
  }
  if (!request.budget && !request.error)
    fail(ErrorKind::input, "precision is 'auto' without a bound; say budget = \"200us\", error = \"0.05N\", or both");
  return bounds;
}

bool is_set(const PrecisionRequest& request, const std::string& dial) {
  return std::any_of(request.sets.begin(), request.sets.end(), [&](const auto& set) { return set.first == dial; });
}

/// Whether a row has what the command line says of its dials.
bool agrees(const Row& row, const Json& parameters, const PrecisionRequest& request) {
  for (const auto& [dial, value] : row.parameters)
    if (is_set(request, dial) && parameters.contains(dial) && !is_same(parameters.at(dial), value)) return false;
  return true;
}

void check_dials(const Table& table, const Json& parameters, const PrecisionRequest& request) {
  if (table.scenario != request.scenario)
    fail(ErrorKind::input, "{} is a table of {}, not of {}; make one with 'verisim tradeoff {} --vary … -o .'",
         request.table, shown(table.scenario, 60), request.scenario, request.scenario);
  for (const Row& row : table.rows)
    for (const auto& [dial, value] : row.parameters)
      if (!parameters.contains(dial))
        fail(ErrorKind::input, "{} varies '{}', which params{{}} does not declare (above this line)", request.table,
             shown(dial, 40));
}

std::string seconds_text(const std::optional<double>& duration) {
  return duration ? fmt::format("{:g} s", *duration) : std::string("its trace");
}

/// In what this run is another trial than the table's: "depth is 0.021 here and 0.02 there"; empty: in nothing.
std::string other_trial(const Table& table, const Json& parameters, const PrecisionRequest& request) {
  std::string other;
  const auto add = [&](const std::string& text) { other += (other.empty() ? "" : ", ") + text; };
  for (const auto& [name, value] : table.fixed)
    if (parameters.contains(name) && !is_same(parameters.at(name), value))
      add(fmt::format("{} is {} here and {} there", shown(name, 40), shown(set_text(parameters.at(name)), 40),
                      shown(set_text(value), 40)));
  const std::optional<double> there = table.duration ? table.duration : request.duration_of_script;
  if (request.duration != there)
    add(fmt::format("it lasts {} here and {} there", seconds_text(request.duration), seconds_text(there)));
  return other;
}

[[noreturn]] void refuse_other_trial(const PrecisionRequest& request, const std::string& other) {
  fail(ErrorKind::input,
       "{} is of another trial: {}; what it says of errors and times need not hold here: make a table of this trial "
       "(verisim tradeoff {} with the same --set and --duration), name the setting with --set and leave precision out, "
       "or say precisionOutside = \"careful\" for its most accurate setting without a promise",
       request.table, other, request.scenario);
}

std::vector<std::string> notices_of(const Table& table, const PrecisionRequest& request, const std::string& other,
                                    const tradeoff::Bounds& bounds, tradeoff::Kind by) {
  std::vector<std::string> notices;
  if (!other.empty())
    notices.push_back(
        fmt::format("precision: {} is of another trial: {}; its most accurate setting is taken, and the bounds are not "
                    "promised",
                    request.table, other));
  if (table.scenario_sha256 != request.scenario_sha256)
    notices.push_back(fmt::format("precision: {} was made before {} was changed; its errors and times need not hold",
                                  request.table, request.scenario));
  const bool has_coverage = bounds.budget_us || by != tradeoff::Kind::flips;
  if (has_coverage && tradeoff::coverage_of(table.repeat) < tradeoff::kWantedCoverage)
    notices.push_back(fmt::format("precision: {}: {}", request.table, tradeoff::coverage_text(table.repeat)));
  return notices;
}

}  // namespace

PrecisionChoice choose_precision(const PrecisionRequest& request, const std::string& table_text) {
  tradeoff::Kind by = tradeoff::Kind::force;
  const tradeoff::Bounds bounds = bounds_of(request, by);
  Table table = tradeoff::table_from(request.table, table_text);
  const Json parameters = parse_json(request.parameters_json);
  check_dials(table, parameters, request);
  for (Row& row : table.rows)
    if (!agrees(row, parameters, request)) row.failed = "the command line says otherwise";
  const std::string other = other_trial(table, parameters, request);
  if (!other.empty() && !request.careful) refuse_other_trial(request, other);
  const std::optional<std::size_t> chosen = tradeoff::choose(
      table.rows, bounds, by, other.empty() ? tradeoff::Prefer::cheapest : tradeoff::Prefer::most_accurate);
  if (!chosen)
    fail(ErrorKind::input,
         "no setting of {} keeps {}; ask for less, or make a table with more settings: verisim tradeoff {} --vary …",
         request.table, tradeoff::text_of(bounds), request.scenario);
  const Row& row = table.rows[*chosen];
  PrecisionChoice choice;
  for (const auto& [dial, value] : row.parameters)
    if (!is_set(request, dial)) choice.sets.emplace_back(dial, set_text(value));
  const tradeoff::ErrorKindInfo& kind = tradeoff::kKinds[index_of(by)];
  const std::optional<tradeoff::Spread>& error = row.errors[index_of(by)];
  choice.event = fmt::format(
      "{}; row {} of {}: {:.3g} us, {} {}; {}; times of {}", tradeoff::text_of(row.parameters), *chosen, request.table,
      row.time_us.most, kind.name, error ? fmt::format("{:.3g} {}", error->most, kind.unit) : std::string("not known"),
      other.empty() ? fmt::format("{:.3g} % of trials", 100 * tradeoff::coverage_of(table.repeat))
                    : std::string("of another trial, nothing is promised"),
      shown(table.cpu, 50));
  choice.notices = notices_of(table, request, other, bounds, by);
  return choice;
}

}  // namespace verisim::script
