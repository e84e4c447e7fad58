#include "engine/script/precision.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "engine/base/error.hpp"
#include "engine/base/text.hpp"
#include "engine/tradeoff/bounds.hpp"

namespace verisim::script {
namespace {

using nlohmann::ordered_json;
using tradeoff::Bounds;
using tradeoff::Row;
using tradeoff::Table;

/// As --set takes it; true and false are texts in a table.
std::string set_text(const ordered_json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

bool is_same(const ordered_json& a, const ordered_json& b) {
  if (a.is_number() && b.is_number()) return a.get<double>() == b.get<double>();
  return set_text(a) == set_text(b);
}

Bounds bounds_of(const PrecisionRequest& request, tradeoff::Kind& by) {
  Bounds bounds;
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
bool agrees(const Row& row, const ordered_json& parameters, const PrecisionRequest& request) {
  for (const auto& [dial, value] : row.parameters)
    if (is_set(request, dial) && parameters.contains(dial) && !is_same(parameters.at(dial), value)) return false;
  return true;
}

void check_dials(const Table& table, const ordered_json& parameters, const PrecisionRequest& request) {
  if (table.scenario != request.scenario)
    fail(ErrorKind::input, "{} is a table of {}, not of {}; make one with 'verisim tradeoff {} --vary … -o .'",
         request.table, shown(table.scenario, 60), request.scenario, request.scenario);
  for (const Row& row : table.rows)
    for (const auto& [dial, value] : row.parameters)
      if (!parameters.contains(dial))
        fail(ErrorKind::input, "{} varies '{}', which params{{}} does not declare (above this line)", request.table,
             shown(dial, 40));
}

std::vector<std::string> notices_of(const Table& table, const ordered_json& parameters,
                                    const PrecisionRequest& request) {
  std::vector<std::string> notices;
  std::string other;
  for (const auto& [name, value] : table.fixed)
    if (parameters.contains(name) && !is_same(parameters.at(name), value))
      other += fmt::format("{}{} is {} here and {} there", other.empty() ? "" : ", ", shown(name, 40),
                           shown(set_text(parameters.at(name)), 40), shown(set_text(value), 40));
  if (!other.empty())
    notices.push_back(fmt::format("precision: {} was made of another trial: {}; its errors and times need not hold",
                                  request.table, other));
  if (table.scenario_sha256 != request.scenario_sha256)
    notices.push_back(fmt::format("precision: {} was made before {} was changed; its errors and times need not hold",
                                  request.table, request.scenario));
  return notices;
}

}  // namespace

PrecisionChoice choose_precision(const PrecisionRequest& request, const std::string& table_text) {
  tradeoff::Kind by = tradeoff::Kind::force;
  const Bounds bounds = bounds_of(request, by);
  Table table = tradeoff::table_from(request.table, table_text);
  const ordered_json parameters = ordered_json::parse(request.parameters_json);
  check_dials(table, parameters, request);
  for (Row& row : table.rows)
    if (!agrees(row, parameters, request)) row.failed = "the command line says otherwise";
  const std::optional<std::size_t> chosen = tradeoff::choose(table.rows, bounds, by);
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
  choice.event = fmt::format("{}; row {} of {}: {:.3g} us, {} {}; {:.0f} % of trials; times of {}",
                             tradeoff::text_of(row.parameters), *chosen, request.table, row.time_us.most, kind.name,
                             error ? fmt::format("{:.3g} {}", error->most, kind.unit) : std::string("not known"),
                             100 * tradeoff::coverage_of(table.repeat), shown(table.cpu, 50));
  choice.notices = notices_of(table, parameters, request);
  return choice;
}

}  // namespace verisim::script
