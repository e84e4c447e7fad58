#include "engine/batch/summary.hpp"
#include "engine/base/json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "engine/base/text_table.hpp"

namespace verisim::batch {

namespace {

constexpr const char* kFigures[] = {"insertion_s", "max_force_N", "max_penetration_m", "overlap_m"};

/// The rows of one group.
struct Gathered {
  std::vector<Cell> values;
  std::uint64_t runs = 0;
  std::map<std::string, std::uint64_t> outcomes;
  std::vector<std::vector<double>> measures;
};

std::string outcome_of(const Cell& status, const Cell& outcome) {
  if (plain_text(status) != "done") return plain_text(status);
  const std::string word = plain_text(outcome);
  return word.empty() ? "no outcome" : word;
}

Group group_of(const Gathered& from, const std::vector<Mean>& columns, std::uint64_t seed, const std::string& name) {
  Group group{.values = from.values, .runs = from.runs, .shares = {}, .means = {}};
  for (const auto& [outcome, count] : from.outcomes)
    group.shares.push_back(
        {outcome, count, static_cast<double>(count) / static_cast<double>(from.runs), wilson(count, from.runs)});
  std::stable_sort(group.shares.begin(), group.shares.end(),
                   [](const Share& a, const Share& b) { return a.count > b.count; });
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (from.measures[i].empty()) continue;
    Mean mean = columns[i];
    mean.runs = from.measures[i].size();
    mean.mean = mean_of(from.measures[i]);
    mean.interval = interval_of_mean(from.measures[i], seed, name + " " + mean.name);
    group.means.push_back(std::move(mean));
  }
  return group;
}

std::string key_text(const std::vector<Cell>& values) {
  std::string text;
  for (const Cell& value : values) text += plain_text(value) + '\n';
  return text;
}

}  // namespace

Summary summarize(Index& index, const std::vector<std::string>& keys, std::uint64_t seed) {
  std::vector<Mean> columns;
  std::vector<std::string> names = index.measure_columns();
  for (const char* figure : kFigures)
    for (const IndexColumn& c : index.layout().figures)
      if (c.name == figure) names.push_back(c.name);
  for (const std::string& name : names)
    columns.push_back({.name = name, .unit = index.unit_of(name), .runs = 0, .mean = 0, .interval = std::nullopt});

  std::vector<std::string> wanted = keys;
  wanted.insert(wanted.end(), {"status", "outcome"});
  wanted.insert(wanted.end(), names.begin(), names.end());
  std::vector<Gathered> gathered;
  std::map<std::string, std::size_t> place;
  index.read(wanted, [&](const std::vector<Cell>& row) {
    const std::vector<Cell> values(row.begin(), row.begin() + static_cast<std::ptrdiff_t>(keys.size()));
    const auto [found, is_new] = place.emplace(key_text(values), gathered.size());
    if (is_new) gathered.push_back({values, 0, {}, std::vector<std::vector<double>>(names.size())});
    Gathered& group = gathered[found->second];
    ++group.runs;
    ++group.outcomes[outcome_of(row[keys.size()], row[keys.size() + 1])];
    for (std::size_t i = 0; i < names.size(); ++i) {
      const Cell& cell = row[keys.size() + 2 + i];
      if (const auto* number = std::get_if<double>(&cell)) group.measures[i].push_back(*number);
    }
  });
  Summary summary{.keys = keys, .groups = {}};
  for (const Gathered& group : gathered)
    summary.groups.push_back(group_of(group, columns, seed, key_text(group.values)));
  return summary;
}

Json to_json(const Summary& summary) {
  Json groups = Json::array();
  for (const Group& group : summary.groups) {
    Json parameters = Json::object(), outcomes = Json::object(), measures = Json::object();
    for (std::size_t i = 0; i < summary.keys.size(); ++i) parameters[summary.keys[i]] = json_of(group.values[i]);
    for (const Share& s : group.shares)
      outcomes[s.outcome] = {
          {"count", s.count}, {"share", s.share}, {"low", s.interval.low}, {"high", s.interval.high}};
    for (const Mean& m : group.means)
      measures[m.name] = {{"mean", m.mean},
                          {"low", m.interval ? Json(m.interval->low) : Json()},
                          {"high", m.interval ? Json(m.interval->high) : Json()},
                          {"unit", m.unit},
                          {"runs", m.runs}};
    groups.push_back(
        {{"parameters", parameters}, {"runs", group.runs}, {"outcomes", outcomes}, {"measures", measures}});
  }
  return groups;
}

std::string table_of(const Summary& summary) {
  constexpr std::size_t kMost = 40;
  std::vector<std::string> names = summary.keys;
  for (const char* name : {"what", "n", "mean or share", "low", "high", "unit"}) names.emplace_back(name);
  TextTable table(names, std::string(summary.keys.size(), '<') + "<>>>><");
  for (std::size_t g = 0; g < std::min(kMost, summary.groups.size()); ++g) {
    const Group& group = summary.groups[g];
    std::vector<std::string> head;
    for (const Cell& value : group.values) head.push_back(plain_text(value));
    const auto add = [&](const std::vector<std::string>& cells) {
      std::vector<std::string> row = head;
      row.insert(row.end(), cells.begin(), cells.end());
      table.add(std::move(row));
      head.assign(head.size(), "");  // said once
    };
    for (const Share& s : group.shares)
      add({s.outcome, fmt::format("{}", s.count), fmt::format("{:.1f}", 100 * s.share),
           fmt::format("{:.1f}", 100 * s.interval.low), fmt::format("{:.1f}", 100 * s.interval.high), "%"});
    for (const Mean& m : group.means)
      add({m.name, fmt::format("{}", m.runs), fmt::format("{:.4g}", m.mean),
           m.interval ? fmt::format("{:.4g}", m.interval->low) : "-",
           m.interval ? fmt::format("{:.4g}", m.interval->high) : "-", m.unit});
  }
  std::string text = table.text();
  if (summary.groups.size() > kMost)
    text += fmt::format("  and {} more groups: --json and index.sqlite have them all\n", summary.groups.size() - kMost);
  return text;
}

}  // namespace verisim::batch
