#include "engine/compare/runs.hpp"
#include "engine/base/json.hpp"

#include <bit>
#include <cstring>
#include <set>

#include "engine/base/error.hpp"
#include "engine/base/run_figures.hpp"
#include "engine/base/text.hpp"
#include "engine/compare/figure_kinds.hpp"
#include "engine/compare/first_difference.hpp"
#include "engine/record/run_file.hpp"

namespace verisim::compare {
namespace {

using Attributes = std::map<std::string, Attribute>;

std::string text_of(const Attributes& attributes, const std::string& name) {
  const auto found = attributes.find(name);
  if (found == attributes.end() || !std::holds_alternative<std::string>(found->second)) return "";
  return std::get<std::string>(found->second);
}

template <typename T>
std::uint64_t sum_of(const std::vector<std::byte>& bytes) {
  std::uint64_t sum = 0;
  for (std::size_t at = 0; at + sizeof(T) <= bytes.size(); at += sizeof(T)) {
    T value;
    std::memcpy(&value, &bytes[at], sizeof value);
    sum += value;
  }
  return sum;
}

Value count_in(const std::map<std::string, std::uint64_t>& counts, const std::string& name) {
  Value value;
  if (const auto found = counts.find(name); found != counts.end()) value = found->second;
  return value;
}

void compare_count(const std::string& name, const Value& a, const Value& b, Comparison& to) {
  ++to.counts_compared;
  if (a == b) return;
  Change change = Change::changed;
  const auto *m = std::get_if<std::uint64_t>(&a), *n = std::get_if<std::uint64_t>(&b);
  if (m != nullptr && n != nullptr) change = change_of_count(name, *n > *m);
  to.counts.push_back({name, a, b, change, ""});
}

void compare_counts_by_name(const std::map<std::string, std::uint64_t>& a,
                            const std::map<std::string, std::uint64_t>& b, Comparison& to) {
  std::set<std::string> names;
  for (const auto* list : {&a, &b})
    for (const auto& [name, count] : *list) names.insert(name);
  for (const std::string& name : names) compare_count(name, count_in(a, name), count_in(b, name), to);
}

Json summary_json(const RunFile& file) {
  Json j = parse_json_or_discard(text_of(file.summary(), "json"));
  return j.is_object() ? j : Json::object();
}

/// How many frames each kind of constraint acted in.
std::map<std::string, std::uint64_t> constraints_of(const Json& summary) {
  std::map<std::string, std::uint64_t> frames;
  if (summary.contains("constraints") && summary["constraints"].is_object())
    for (const auto& [name, count] : summary["constraints"].items())
      if (count.is_number_unsigned()) frames["constraints." + name] = count.get<std::uint64_t>();
  return frames;
}

std::map<std::string, double> measures_of(const Json& summary) {
  std::map<std::string, double> values;
  if (summary.contains("measures") && summary["measures"].is_object())
    for (const auto& [name, measure] : summary["measures"].items())
      if (measure.is_object() && measure.contains("value") && measure["value"].is_number())
        values[name] = measure["value"].get<double>();
  return values;
}

Value value_of(const Json& j) {
  if (j.is_number_unsigned()) return j.get<std::uint64_t>();
  if (j.is_number()) return j.get<double>();
  if (j.is_string()) return j.get<std::string>();
  return {};
}

void compare_counts(const RunFile& a, const RunFile& b, const Json& of_a, const Json& of_b, Comparison& to) {
  compare_counts_by_name(work_counts(a), work_counts(b), to);
  for (const RunFigure& figure : run_figures()) {
    const std::string name = figure.name;
    if (kind_of_figure(name) != FigureKind::count || !of_a.contains(name) || !of_b.contains(name)) continue;
    compare_count(name, value_of(of_a[name]), value_of(of_b[name]), to);
  }
  compare_counts_by_name(constraints_of(of_a), constraints_of(of_b), to);
}

/// Words that have to be the same: `change` says what it means if they are not.
AccuracyFigure same_word(const std::string& name, const std::string& a, const std::string& b, Change change) {
  return {.name = name, .a = a, .b = b, .bound = 0.0, .change = a == b ? Change::none : change, .note = ""};
}

void compare_accuracy(const Json& of_a, const Json& of_b, const Bounds& bounds, Comparison& to) {
  for (const RunFigure& figure : run_figures()) {
    const std::string name = figure.name;
    if (kind_of_figure(name) != FigureKind::number) continue;
    if (of_a.contains(name) && of_b.contains(name) && of_a[name].is_number() && of_b[name].is_number())
      to.accuracy.push_back(bounds.judge(name, of_a[name].get<double>(), of_b[name].get<double>()));
  }
  const std::map<std::string, double> measures_a = measures_of(of_a), measures_b = measures_of(of_b);
  for (const auto& [name, value] : measures_a) {
    const auto other = measures_b.find(name);
    if (other == measures_b.end())
      to.only_a.push_back("measure '" + name + "'");
    else
      to.accuracy.push_back(bounds.judge(name, value, other->second));
  }
  for (const auto& [name, value] : measures_b)
    if (measures_a.count(name) == 0) to.only_b.push_back("measure '" + name + "'");
  const auto word = [](const Json& j, const char* name) {
    return j.contains(name) && j[name].is_string() ? j[name].get<std::string>() : std::string();
  };
  const std::string source = "penetration_source";
  if (word(of_a, "penetration_source") != word(of_b, "penetration_source"))
    to.accuracy.push_back(same_word(source, word(of_a, source.c_str()), word(of_b, source.c_str()), Change::changed));
}

void compare_outcomes(const RunFile& a, const RunFile& b, Comparison& to) {
  const auto add = [&](const char* name, const std::string& of_a, const std::string& of_b, Change change) {
    to.outcomes.push_back({name, of_a, of_b, of_a == of_b ? Change::none : change, ""});
  };
  const auto end = [](const RunFile& file) {
    return file.summary().empty() ? std::string("killed") : text_of(file.summary(), "end");
  };
  const std::string end_a = end(a), end_b = end(b);
  add("outcome", text_of(a.summary(), "outcome"), text_of(b.summary(), "outcome"), Change::changed);
  add("end", end_a, end_b, end_a == "done" ? Change::worse : end_b == "done" ? Change::better : Change::changed);
}

/// One run of each says nothing of time: shown, never judged.
void show_times(const std::map<std::string, double>& a, const std::map<std::string, double>& b, Comparison& to) {
  std::vector<TimeSamples> samples;
  for (const auto& [name, unit, scale] :
       {std::tuple("wall_s", "s", 1.0), std::tuple("load_s", "s", 1.0), std::tuple("frame_ns.p50", "us", 1e-3),
        std::tuple("collision_frame_ns.p50", "us", 1e-3)}) {
    const auto of_a = a.find(name), of_b = b.find(name);
    if (of_a != a.end() && of_b != b.end() && of_a->second > 0 && of_b->second > 0)
      samples.push_back({.name = name, .unit = unit, .a = {of_a->second * scale}, .b = {of_b->second * scale}});
  }
  to.times = judge_times(samples, {.effect = 0, .alpha = kAlphaApart});
}

void note_what_differs(const RunFile& a, const RunFile& b, Comparison& to) {
  const Attributes &of_a = a.header().attributes, &of_b = b.header().attributes;
  const Json p = parse_json_or_discard(text_of(of_a, "parameters"));
  const Json q = parse_json_or_discard(text_of(of_b, "parameters"));
  std::set<std::string> keys;
  for (const Json* parameters : {&p, &q})
    if (parameters->is_object())
      for (const auto& [key, value] : parameters->items()) keys.insert(key);
  for (const std::string& key : keys) {
    const Json x = p.is_object() ? p.value(key, Json()) : Json(), y = q.is_object() ? q.value(key, Json()) : Json();
    if (x != y)
      to.notices.push_back(shown(fmt::format("parameter {} is {} in A, {} in B", key, json_text(x), json_text(y))));
  }
  const auto is_other = [&](const char* name) {
    const auto x = of_a.find(name), y = of_b.find(name);
    return x != of_a.end() && y != of_b.end() && x->second != y->second;
  };
  for (const char* name : {"seed", "dt"})
    if (is_other(name)) to.notices.push_back(fmt::format("the runs have another {}", name));
  const auto simulated = [](const RunFile& file) {
    const std::map<std::string, double> numbers = numbers_of(file);
    const auto found = numbers.find("simulated_s");
    return found == numbers.end() ? 0 : found->second;
  };
  if (const double x = simulated(a), y = simulated(b); x != y)
    to.notices.push_back(
        fmt::format("A simulates {:g} s, B {:g} s: counts, largest values and times are of other spans", x, y));
  if (is_other("scenario_sha256")) to.notices.push_back("the text of the scenario is not the same");
  if (is_other("cpu")) to.notices.push_back("the runs are of different processors: times tell nothing");
}

}  // namespace

std::map<std::string, std::uint64_t> work_counts(const RunFile& file) {
  std::map<std::string, std::uint64_t> counts;
  for (const Column& column : file.schema().columns()) {
    if (!column.path.starts_with("/cost/")) continue;
    const std::vector<std::byte> bytes = file.column(column);
    if (column.dtype == Dtype::u64) counts[column.path] = sum_of<std::uint64_t>(bytes);
    if (column.dtype == Dtype::u32) counts[column.path] = sum_of<std::uint32_t>(bytes);
  }
  return counts;
}

std::map<std::string, double> numbers_of(const RunFile& file) {
  std::map<std::string, double> numbers;
  const Json summary = summary_json(file);
  for (const auto& [name, value] : summary.items()) {
    if (value.is_number()) numbers[name] = value.get<double>();
    if (value.is_object() && name.ends_with("_ns"))
      for (const auto& [quantile, ns] : value.items())
        if (ns.is_number()) numbers[name + "." + quantile] = ns.get<double>();
  }
  for (const auto& [name, value] : measures_of(summary)) numbers[name] = value;
  return numbers;
}

Origin origin_of(const RunFile& file, const std::string& path) {
  return {path, text_of(file.header().attributes, "version"), text_of(file.header().attributes, "commit")};
}

Comparison compare_runs(const std::string& path_a, const std::string& path_b, const Bounds& bounds) {
  const RunFile a(path_a), b(path_b);
  const std::string scenario_a = text_of(a.header().attributes, "scenario"),
                    scenario_b = text_of(b.header().attributes, "scenario");
  if (scenario_a != scenario_b)
    fail(ErrorKind::input, "{} is a run of {}, {} one of {}; compare runs of the same scenario", path_a,
         shown(scenario_a), path_b, shown(scenario_b));
  Comparison c{.kind = "runs", .a = origin_of(a, path_a), .b = origin_of(b, path_b)};
  note_what_differs(a, b, c);
  const Json of_a = summary_json(a), of_b = summary_json(b);
  compare_counts(a, b, of_a, of_b, c);
  compare_accuracy(of_a, of_b, bounds, c);
  c.accuracy.push_back(same_word("state_hash", text_of(a.header().attributes, "state_hash"),
                                 text_of(b.header().attributes, "state_hash"), Change::bits));
  compare_outcomes(a, b, c);
  show_times(numbers_of(a), numbers_of(b), c);
  StateDifference state = state_difference(a, b);
  c.first_difference = std::move(state.first);
  for (const std::string& path : state.only_a) c.only_a.push_back(path);
  for (const std::string& path : state.only_b) c.only_b.push_back(path);
  return c;
}

}  // namespace verisim::compare
