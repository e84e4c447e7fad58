#include "engine/compare/batches.hpp"
#include "engine/base/json.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "engine/base/error.hpp"
#include "engine/base/run_figures.hpp"
#include "engine/base/text.hpp"
#include "engine/base/user_file.hpp"
#include "engine/compare/conditions.hpp"
#include "engine/compare/figure_kinds.hpp"
#include "engine/compare/index_table.hpp"

namespace verisim::compare {
namespace {

struct BatchFolder {
  std::string path, scenario, sha256;
  Origin origin;
  IndexTable index;
};

std::string word_in(const Json& j, const char* key) {
  return j.contains(key) && j[key].is_string() ? j[key].get<std::string>() : std::string();
}

BatchFolder open_folder(const std::string& path) {
  const std::string file = path + "/batch.json";
  if (!identity_of(file))
    fail(ErrorKind::input, "{}: has no batch.json; name a folder that `verisim batch` wrote", path);
  const Json j = parse_json_of(file, UserFile(file, file).content(), "make the batch again");
  if (!j.is_object() || (j.contains("format") && j["format"] != "verisim-batch"))
    fail(ErrorKind::input, "{}: is not what `verisim batch` writes", file);
  if (j.contains("format_version") && j["format_version"] != kBatchFormat)
    fail(ErrorKind::input, "{}: is of format {}, this verisim reads format {}; compare with the verisim that wrote it",
         file, json_text(j["format_version"]), kBatchFormat);
  const std::string index = path + "/index.csv";
  if (!identity_of(index))
    fail(ErrorKind::input, "{}: has no index.csv: the batch has not ended; call the same `verisim batch` again", path);
  const std::string scenario = std::filesystem::path(word_in(j, "scenario")).filename().string();
  return {path,
          scenario,
          word_in(j, "scenario_sha256"),
          {path, word_in(j, "version"), word_in(j, "commit")},
          IndexTable(index)};
}

/// The columns between `seed` and `status`.
std::set<std::string> parameters_of(const IndexTable& index) {
  const std::size_t from = index.find("seed").value_or(0) + 1;
  const std::size_t to = index.find("status").value_or(from);
  std::set<std::string> names;
  for (std::size_t i = from; i < to; ++i) names.insert(index.columns()[i]);
  return names;
}

struct Pair {
  std::size_t row_a, row_b;
};

/// What makes a run the same in both: its seed and the parameters that both batches have.
std::string key_of(const IndexTable& index, std::size_t row, const std::set<std::string>& parameters) {
  std::string key;
  for (const auto& name : parameters) key += index.cell(row, *index.find(name)) + "\n";
  const auto seed = index.find("seed");
  return key + (seed ? index.cell(row, *seed) : "");
}

std::string run_of(const IndexTable& index, std::size_t row) {
  return "run " + index.cell(row, *index.find("run"));
}

/// Whether an option overruled the parameter (--duration, --seed): runs that were done have no value of it.
bool is_overruled(const IndexTable& index, const char* parameter) {
  const auto column = index.find(parameter), status = index.find("status");
  if (!column || !status) return false;
  bool any = false;
  for (std::size_t row = 0; row < index.rows(); ++row) {
    if (index.cell(row, *status) != "done") continue;
    if (!index.cell(row, *column).empty()) return false;
    any = true;
  }
  return any;
}

std::vector<Pair> pairs_of(const IndexTable& a, const IndexTable& b, Comparison& to) {
  std::set<std::string> common, overruled;
  const std::set<std::string> of_a = parameters_of(a), of_b = parameters_of(b);
  std::set_intersection(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(), std::inserter(common, common.end()));
  for (const char* name : {"duration", "parameter.seed"}) {
    if (common.count(name) == 0) continue;
    const bool in_a = is_overruled(a, name), in_b = is_overruled(b, name);
    if (!in_a && !in_b) continue;
    common.erase(name);
    overruled.insert(name);
    if (in_a != in_b)
      to.notices.push_back(
          fmt::format("parameter '{}' has no effect in {}: an option says otherwise", name, in_a ? "A" : "B"));
  }
  for (const std::string& name : of_a)
    if (common.count(name) + overruled.count(name) == 0)
      to.notices.push_back("parameter '" + shown(name, 60) + "' is only in A");
  for (const std::string& name : of_b)
    if (common.count(name) + overruled.count(name) == 0)
      to.notices.push_back("parameter '" + shown(name, 60) + "' is only in B");
  std::map<std::string, std::vector<std::size_t>> rows_of_b;
  for (std::size_t row = b.rows(); row-- > 0;) rows_of_b[key_of(b, row, common)].push_back(row);
  std::vector<Pair> pairs;
  for (std::size_t row = 0; row < a.rows(); ++row) {
    std::vector<std::size_t>& left = rows_of_b[key_of(a, row, common)];
    if (left.empty()) {
      to.only_a.push_back(run_of(a, row));
      continue;
    }
    pairs.push_back({row, left.back()});
    left.pop_back();
  }
  std::set<std::size_t> alone;
  for (const auto& [key, rows] : rows_of_b) alone.insert(rows.begin(), rows.end());
  for (const std::size_t row : alone) to.only_b.push_back(run_of(b, row));
  return pairs;
}

/// Both batches' values of one column, by pairs.
struct PairedColumn {
  std::string name;
  std::vector<std::pair<std::string, std::string>> cells;
};

void compare_count(const PairedColumn& column, Comparison& to) {
  std::uint64_t sum_a = 0, sum_b = 0;
  std::size_t differing = 0;
  for (const auto& [x, y] : column.cells) {
    const std::optional<double> of_a = number_in(x), of_b = number_in(y);
    sum_a += of_a && *of_a >= 0 ? static_cast<std::uint64_t>(*of_a) : 0;
    sum_b += of_b && *of_b >= 0 ? static_cast<std::uint64_t>(*of_b) : 0;
    if (x != y) ++differing;
  }
  ++to.counts_compared;
  if (differing == 0) return;
  const Change change = sum_a == sum_b ? Change::changed : change_of_count(column.name, sum_b > sum_a);
  to.counts.push_back(
      {column.name, sum_a, sum_b, change, fmt::format("in {} of {} runs", differing, column.cells.size())});
}

void compare_number(const PairedColumn& column, const Bounds& bounds, Comparison& to) {
  double sum_a = 0, sum_b = 0, largest = 0;
  std::size_t both = 0, differing = 0, one_only = 0;
  for (const auto& [x, y] : column.cells) {
    const std::optional<double> of_a = number_in(x), of_b = number_in(y);
    if (x != y) ++differing;
    if (of_a.has_value() != of_b.has_value()) ++one_only;
    if (!of_a || !of_b) continue;
    ++both;
    sum_a += *of_a;
    sum_b += *of_b;
    largest = std::max(largest, std::abs(*of_b - *of_a));
  }
  if (both == 0 && one_only == 0) return;
  const auto n = static_cast<double>(std::max<std::size_t>(both, 1));
  AccuracyFigure figure = bounds.judge(column.name, sum_a / n, sum_b / n);
  if (differing > 0)
    figure.note += fmt::format("{}{} of {} runs differ, by {:.3g} at most", figure.note.empty() ? "" : "; ", differing,
                               column.cells.size(), largest);
  if (one_only > 0) figure.note += fmt::format("; only one of A and B has it in {} runs", one_only);
  if (figure.change == Change::none && differing > 0) figure.change = Change::bits;
  to.accuracy.push_back(std::move(figure));
}

void compare_hash(const PairedColumn& column, Comparison& to) {
  const auto differing = static_cast<std::size_t>(std::count_if(
      column.cells.begin(), column.cells.end(), [](const auto& cell) { return cell.first != cell.second; }));
  to.accuracy.push_back({.name = column.name,
                         .a = fmt::format("{} runs", column.cells.size()),
                         .b = fmt::format("{} equal", column.cells.size() - differing),
                         .bound = 0.0,
                         .change = differing > 0 ? Change::bits : Change::none,
                         .note = ""});
}

/// How many runs ended with each word, and how many have another one than their partner.
void compare_words(const PairedColumn& column, const Bounds& bounds, Comparison& to) {
  std::map<std::string, std::pair<std::uint64_t, std::uint64_t>> counts;
  std::map<std::string, std::size_t> flips;
  std::size_t flipped = 0;
  for (const auto& [x, y] : column.cells) {
    ++counts[x].first;
    ++counts[y].second;
    if (x == y) continue;
    ++flipped;
    ++flips[fmt::format("'{}' became '{}'", shown(x, 40), shown(y, 40))];
  }
  const bool is_beyond = static_cast<double>(flipped) > bounds.flips * static_cast<double>(column.cells.size());
  const bool is_status = column.name == "status";
  for (const auto& [word, count] : counts) {
    Change change = Change::none;
    if (count.first != count.second && is_beyond) {
      change = Change::changed;
      if (is_status && counts.count("done") != 0 && counts["done"].first != counts["done"].second)
        change = counts["done"].second < counts["done"].first ? Change::worse : Change::better;
    }
    to.outcomes.push_back(
        {fmt::format("{} '{}'", column.name, shown(word, 60)), count.first, count.second, change, ""});
  }
  for (const auto& [what, runs] : flips)
    to.outcomes.push_back({fmt::format("{} {}", column.name, what), Value(), Value(static_cast<std::uint64_t>(runs)),
                           is_beyond ? Change::changed : Change::none, ""});
}

void compare_column(const PairedColumn& column, const Bounds& bounds, Comparison& to) {
  switch (kind_of_figure(column.name)) {
    case FigureKind::skipped:
      return;
    case FigureKind::count:
      return compare_count(column, to);
    case FigureKind::hash:
      return compare_hash(column, to);
    case FigureKind::word:
      return compare_words(column, bounds, to);
    case FigureKind::number:
      return compare_number(column, bounds, to);
  }
}

void compare_columns(const IndexTable& a, const IndexTable& b, const std::vector<Pair>& pairs, const Bounds& bounds,
                     Comparison& to) {
  const std::set<std::string> parameters = parameters_of(a);
  for (std::size_t i = 0; i < a.columns().size(); ++i) {
    const std::string& name = a.columns()[i];
    if (parameters.count(name) != 0 || kind_of_figure(name) == FigureKind::skipped) continue;
    const auto other = b.find(name);
    if (!other) {
      to.only_a.push_back("column " + name);
      continue;
    }
    PairedColumn column{name, {}};
    for (const Pair& pair : pairs) column.cells.emplace_back(a.cell(pair.row_a, i), b.cell(pair.row_b, *other));
    compare_column(column, bounds, to);
  }
  for (const std::string& name : b.columns())
    if (!a.find(name) && parameters_of(b).count(name) == 0 && kind_of_figure(name) != FigureKind::skipped)
      to.only_b.push_back("column " + name);
}

/// The row of timing.csv of each run.
std::map<std::string, std::size_t> rows_of_runs(const IndexTable& table) {
  std::map<std::string, std::size_t> rows;
  for (std::size_t row = 0; row < table.rows(); ++row) rows[table.cell(row, *table.find("run"))] = row;
  return rows;
}

/// Nothing where a run that did not end has no time. Error(input) if it is none.
std::optional<double> time_at(const IndexTable& table, std::size_t row, std::size_t column) {
  const std::string& text = table.cell(row, column);
  if (text.empty()) return {};
  const std::optional<double> time = number_in(text);
  if (!time || !std::isfinite(*time) || *time < 0)
    fail(ErrorKind::input, "{}: '{}' of {} is no time; make the batch again", table.place(row), shown(text, 40),
         table.columns()[column]);
  if (*time == 0) return {};  // of frames with contact, where there were none
  return time;
}

/// The rows of timing.csv of pairs that have one in both.
std::vector<TimedPair> timed(const BatchFolder& a, const BatchFolder& b, const std::vector<Pair>& pairs,
                             const IndexTable& times_a, const IndexTable& times_b) {
  const auto rows_a = rows_of_runs(times_a), rows_b = rows_of_runs(times_b);
  std::vector<TimedPair> both;
  for (const Pair& pair : pairs) {
    const auto row_a = rows_a.find(a.index.cell(pair.row_a, *a.index.find("run")));
    const auto row_b = rows_b.find(b.index.cell(pair.row_b, *b.index.find("run")));
    if (row_a != rows_a.end() && row_b != rows_b.end()) both.push_back({row_a->second, row_b->second});
  }
  return both;
}

std::vector<TimeSamples> samples_of(const IndexTable& a, const IndexTable& b, const std::vector<TimedPair>& pairs,
                                    bool is_judged) {
  std::vector<TimeSamples> samples;
  for (const auto& [name, unit] : {std::pair("process_s", "s"), std::pair("load_s", "s"), std::pair("wall_s", "s"),
                                   std::pair("frame_ns.p50", "ns"), std::pair("collision_frame_ns.p50", "ns")}) {
    const auto of_a = a.find(name), of_b = b.find(name);
    if (!of_a || !of_b) continue;
    TimeSamples s{.name = name, .unit = unit, .is_paired = true, .is_judged = is_judged};
    for (const TimedPair& pair : pairs) {
      const auto x = time_at(a, pair.row_a, *of_a), y = time_at(b, pair.row_b, *of_b);
      if (!x || !y) continue;
      s.a.push_back(*x);
      s.b.push_back(*y);
    }
    if (!s.a.empty()) samples.push_back(std::move(s));
  }
  return samples;
}

void compare_times(const BatchFolder& a, const BatchFolder& b, const std::vector<Pair>& pairs, const Bounds& bounds,
                   Comparison& to) {
  for (const BatchFolder* folder : {&a, &b})
    if (!identity_of(folder->path + "/timing.csv")) {
      to.notices.push_back(folder->path + " has no timing.csv: times are not compared");
      return;
    }
  const IndexTable times_a(a.path + "/timing.csv"), times_b(b.path + "/timing.csv");
  const std::vector<TimedPair> all = timed(a, b, pairs, times_a, times_b);
  const ComparableTimes comparable = comparable_times(times_a, times_b, all);
  const bool is_judged = !comparable.pairs.empty();
  const std::vector<TimeSamples> samples = samples_of(times_a, times_b, is_judged ? comparable.pairs : all, is_judged);
  if (samples.empty()) return;
  to.times = judge_times(samples, {.effect = bounds.effect_apart, .alpha = kAlphaApart});
  if (!is_judged) {
    to.notices.push_back("times not comparable: " + comparable.difference);
    for (TimeFigure& figure : to.times) figure.note = "not comparable: " + comparable.difference;
    return;
  }
  if (!comparable.difference.empty())
    to.notices.push_back(fmt::format("times of {} of {} runs not comparable, and left out: {}",
                                     all.size() - comparable.pairs.size(), all.size(), comparable.difference));
  if (!comparable.is_known)
    to.notices.emplace_back(
        "not told by both: with how many jobs, which cache and on what machine they were computed; where these differ "
        "times tell nothing");
  to.notices.push_back(
      fmt::format("one batch was computed after the other: times count from {:.0f} % on; --programs "
                  "measures in turns",
                  100 * bounds.effect_apart));
}

/// Runs of other spans of time do not cost the same.
void note_other_durations(const IndexTable& a, const IndexTable& b, const std::vector<Pair>& pairs, Comparison& to) {
  const auto of_a = a.find("simulated_s"), of_b = b.find("simulated_s");
  if (!of_a || !of_b) return;
  const auto other = std::count_if(pairs.begin(), pairs.end(), [&](const Pair& pair) {
    return a.cell(pair.row_a, *of_a) != b.cell(pair.row_b, *of_b);
  });
  if (other > 0)
    to.notices.push_back(
        fmt::format("{} of {} runs simulate another time in B (simulated_s): counts, largest values and times are of "
                    "other spans",
                    other, pairs.size()));
}

/// A list that no reader would go through is cut, and says how much is left out.
void shorten(std::vector<std::string>& list) {
  constexpr std::size_t kMost = 20;
  if (list.size() <= kMost) return;
  const std::string rest = fmt::format("and {} more", list.size() - kMost);
  list.resize(kMost);
  list.push_back(rest);
}

}  // namespace

Comparison compare_batches(const std::string& path_a, const std::string& path_b, const Bounds& bounds) {
  const BatchFolder a = open_folder(path_a), b = open_folder(path_b);
  if (a.scenario != b.scenario)
    fail(ErrorKind::input, "{} is a batch of {}, {} one of {}; compare batches of the same scenario", path_a,
         shown(a.scenario), path_b, shown(b.scenario));
  Comparison c{.kind = "batches", .a = a.origin, .b = b.origin};
  if (a.sha256 != b.sha256) c.notices.emplace_back("the text of the scenario is not the same");
  const std::vector<Pair> pairs = pairs_of(a.index, b.index, c);
  c.notices.push_back(fmt::format("{} runs are in both, with the same parameters and seed", pairs.size()));
  if (!pairs.empty()) {
    note_other_durations(a.index, b.index, pairs, c);
    compare_columns(a.index, b.index, pairs, bounds, c);
    compare_times(a, b, pairs, bounds, c);
  }
  shorten(c.only_a);
  shorten(c.only_b);
  return c;
}

}  // namespace verisim::compare
