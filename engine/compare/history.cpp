#include "engine/compare/history.hpp"
#include "engine/base/json.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "engine/base/error.hpp"
#include "engine/base/text.hpp"
#include "engine/base/text_table.hpp"
#include "engine/base/user_file.hpp"
#include "engine/compare/benchmarks.hpp"
#include "engine/compare/runs.hpp"
#include "engine/compare/shift.hpp"
#include "engine/record/run_file.hpp"

namespace verisim::compare {
namespace {

namespace fs = std::filesystem;

constexpr const char* kUsualFigures[] = {"/cost/bytes_touched", "/cost/lookups", "max_penetration_m", "max_force_N",
                                         "frame_ns.p50"};
constexpr std::size_t kUsualBenchmarks = 5;

HistoryEntry entry_of_run(const std::string& path, std::string& scenario, std::string& of) {
  const RunFile file(path);
  const auto named = file.header().attributes.find("scenario");
  const std::string own = named != file.header().attributes.end() && std::holds_alternative<std::string>(named->second)
                              ? std::get<std::string>(named->second)
                              : "";
  if (!of.empty() && own != scenario)
    fail(ErrorKind::input, "{} is a run of {}, {} one of {}; a history is of one scenario", of, shown(scenario), path,
         shown(own));
  scenario = own;
  of = path;
  HistoryEntry entry{.file = "", .origin = origin_of(file, path), .figures = numbers_of(file)};
  for (const auto& [name, count] : work_counts(file)) entry.figures[name] = static_cast<double>(count);
  return entry;
}

HistoryEntry entry_of_benchmarks(const std::string& path) {
  const BenchmarkFile file = read_benchmarks(path);
  HistoryEntry entry{.file = "", .origin = file.origin, .figures = {}};
  for (const Benchmark& b : file.benchmarks)
    entry.figures[b.name] = nanoseconds_of(b.unit) * median_of(goes_by_real_time(b.name) ? b.real : b.cpu);
  return entry;
}

std::vector<std::string> files_in(const std::string& folder) {
  if (other_than_plain(folder) != "a folder")
    fail(ErrorKind::input, "{}: is no folder; --history takes one with a run file or benchmark JSON of each version",
         folder);
  std::vector<std::string> names;
  std::error_code unreadable;
  for (const auto& item : fs::directory_iterator(folder, unreadable)) {
    const std::string name = item.path().filename().string();
    if (!name.starts_with(".") && (name.ends_with(".h5") || name.ends_with(".json"))) names.push_back(name);
  }
  if (unreadable) fail(ErrorKind::input, "{}: cannot be read ({})", folder, unreadable.message());
  if (names.empty()) fail(ErrorKind::input, "{}: has no file that ends in .h5 or .json", folder);
  std::sort(names.begin(), names.end());
  return names;
}

bool has(const History& history, const std::string& figure) {
  return std::any_of(history.entries.begin(), history.entries.end(),
                     [&](const HistoryEntry& entry) { return entry.figures.count(figure) != 0; });
}

std::vector<std::string> all_figures(const History& history) {
  std::vector<std::string> names;
  for (const HistoryEntry& entry : history.entries)
    for (const auto& [name, value] : entry.figures)
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  return names;
}

void choose_figures(History& history) {
  for (const char* name : kUsualFigures)
    if (has(history, name)) history.figures.emplace_back(name);
  if (!history.figures.empty()) return;
  history.figures = all_figures(history);
  if (history.figures.size() > kUsualBenchmarks) history.figures.resize(kUsualBenchmarks);
}

/// By how much a value is above the one before, as a fraction.
std::optional<double> change_from(std::optional<double> before, double value) {
  if (!before || *before == 0 || !std::isfinite(*before) || !std::isfinite(value)) return {};
  return (value - *before) / std::abs(*before);
}

/// Calls `take(entry, value, change)` for each entry that has the figure.
template <typename Take>
void for_each_value(const History& history, const std::string& figure, const Take& take) {
  std::optional<double> before;
  for (const HistoryEntry& entry : history.entries) {
    const auto found = entry.figures.find(figure);
    if (found == entry.figures.end()) continue;
    take(entry, found->second, change_from(before, found->second));
    before = found->second;
  }
}

}  // namespace

History read_history(const std::string& folder, const std::vector<std::string>& figures) {
  History history{.entries = {}, .figures = figures};
  std::string scenario, run;  // of the run before
  for (const std::string& name : files_in(folder)) {
    const std::string path = folder + "/" + name;
    history.entries.push_back(name.ends_with(".json") ? entry_of_benchmarks(path) : entry_of_run(path, scenario, run));
    history.entries.back().file = name;
  }
  for (const std::string& figure : figures) {
    if (has(history, figure)) continue;
    const std::vector<std::string> known = all_figures(history);
    const std::string near = nearest_name(figure, known);
    fail(ErrorKind::input, "{}: no file has a figure '{}'; {}", folder, shown(figure, 60),
         near.empty()
             ? fmt::format(
                   "one of them has {} ...",
                   fmt::join(known.begin(),
                             known.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(known.size(), 6)), ", "))
             : "did you mean '" + near + "'?");
  }
  if (figures.empty()) choose_figures(history);
  return history;
}

std::string table_of(const History& history) {
  std::string text;
  for (const std::string& figure : history.figures) {
    TextTable table({shown(figure, 60), "version", "commit", "value", "to the one before", ""});
    for_each_value(history, figure, [&](const HistoryEntry& entry, double value, std::optional<double> change) {
      table.add({shown(entry.file, 60), shown(entry.origin.version, 20), shown(entry.origin.commit, 20),
                 fmt::format("{:.9g}", value), change ? fmt::format("{:+.3g} %", 100 * *change) : "", ""});
    });
    text += table.text();
  }
  return text;
}

Json json_of(const History& history) {
  Json j = {{"history", Json::array()}};
  for (const std::string& figure : history.figures) {
    Json rows = Json::array();
    for_each_value(history, figure, [&](const HistoryEntry& entry, double value, std::optional<double> change) {
      rows.push_back({{"file", entry.file},
                      {"version", entry.origin.version},
                      {"commit", entry.origin.commit},
                      {"value", value},
                      {"change", change ? Json(*change) : Json()}});
    });
    j["history"].push_back({{"figure", figure}, {"rows", rows}});
  }
  return j;
}

}  // namespace verisim::compare
