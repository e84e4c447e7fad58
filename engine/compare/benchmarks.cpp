#include "engine/compare/benchmarks.hpp"
#include "engine/base/json.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "engine/base/error.hpp"
#include "engine/base/text.hpp"
#include "engine/base/user_file.hpp"

namespace verisim::compare {
namespace {

constexpr const char* kHowToWrite = "write it with --benchmark_out=FILE --benchmark_repetitions=20";

const std::map<std::string, double>& units_in_ns() {
  static const std::map<std::string, double> ns = {{"ns", 1}, {"us", 1e3}, {"ms", 1e6}, {"s", 1e9}};
  return ns;
}

/// NaN and infinity, which Google Benchmark writes as they are and JSON does not know.
bool has_words_of_no_number(const std::string& text) {
  constexpr const char* kWords[] = {": NaN", ": nan", ": -nan", ": inf", ": -inf", "nfinity"};
  return std::any_of(std::begin(kWords), std::end(kWords),
                     [&](const char* word) { return text.find(word) != std::string::npos; });
}

Json parsed(const std::string& path, const std::string& text) {
  if (has_words_of_no_number(text) && parse_json_or_discard(text).is_discarded())
    fail(ErrorKind::input, "{}: has a NaN or an infinity, which are no times; measure it again", path);
  return parse_json_of(path, text, kHowToWrite);
}

double time_in(const std::string& path, const std::string& name, const Json& entry, const char* key) {
  const double time = entry.contains(key) && entry[key].is_number() ? entry[key].get<double>() : std::nan("");
  if (!(time > 0) || !std::isfinite(time))
    fail(ErrorKind::input, "{}: {}: its {} is no time above 0; measure it again", path, shown(name, 100), key);
  return time;
}

void read_context(const Json& context, BenchmarkFile& to) {
  static const std::set<std::string> kOfTheMoment = {"date", "load_avg", "executable", "caches", "mhz_per_cpu"};
  for (const auto& [key, value] : context.items()) {
    const std::string text = value.is_string() ? value.get<std::string>() : json_text(value);
    if (key == "commit") to.origin.commit = text;
    if (key != "commit" && kOfTheMoment.count(key) == 0) to.context.emplace_back(key, text);
  }
}

/// What Google Benchmark itself says of a repetition: all else is a counter of the benchmark's.
bool is_google_own(const std::string& key) {
  static const std::set<std::string> kOwn = {"family_index",     "per_family_instance_index",
                                             "repetitions",      "repetition_index",
                                             "threads",          "iterations",
                                             "real_time",        "cpu_time",
                                             "bytes_per_second", "items_per_second"};
  return kOwn.count(key) > 0;
}

/// Adds a repetition, or nothing for a mean, median or deviation.
void read_entry(const std::string& path, const Json& entry, BenchmarkFile& to) {
  if (!entry.is_object() || !entry.contains("name") || !entry["name"].is_string())
    fail(ErrorKind::input, "{}: a benchmark has no name; {}", path, kHowToWrite);
  const std::string name = entry.value("run_name", entry["name"].get<std::string>());
  if (entry.value("run_type", "iteration") != "iteration") return;
  if (entry.value("error_occurred", false))
    fail(ErrorKind::input, "{}: {} ended with an error: {}", path, shown(name, 100),
         shown(entry.value("error_message", ""), 200));
  const std::string unit = entry.value("time_unit", "ns");
  if (units_in_ns().count(unit) == 0)
    fail(ErrorKind::input, "{}: {}: '{}' is no unit of time", path, shown(name, 100), shown(unit, 20));
  auto same =
      std::find_if(to.benchmarks.begin(), to.benchmarks.end(), [&](const Benchmark& b) { return b.name == name; });
  if (same == to.benchmarks.end())
    same = to.benchmarks.insert(same, {.name = name, .unit = unit, .real = {}, .cpu = {}});
  if (same->unit != unit) fail(ErrorKind::input, "{}: {}: its repetitions have several units", path, shown(name, 100));
  same->real.push_back(time_in(path, name, entry, "real_time"));
  same->cpu.push_back(time_in(path, name, entry, "cpu_time"));
  for (const auto& [key, value] : entry.items())
    if (value.is_number() && !is_google_own(key)) same->counters[key].push_back(value.get<double>());
}

/// B's times in A's unit.
std::vector<double> scaled(std::vector<double> times, double factor) {
  for (double& time : times) time *= factor;
  return times;
}

/// The one value that a counter has in all repetitions, two or more.
std::optional<double> count_of(const Benchmark& benchmark, const std::string& counter) {
  const auto found = benchmark.counters.find(counter);
  if (found == benchmark.counters.end()) return {};
  const std::vector<double>& values = found->second;
  const bool is_one = std::all_of(values.begin(), values.end(), [&](double v) { return v == values.front(); });
  return is_one && values.size() > 1 && values.size() == benchmark.real.size() ? std::optional(values.front())
                                                                               : std::nullopt;
}

void compare_counts(const Benchmark& a, const Benchmark& b, Comparison& to) {
  std::set<std::string> names;
  for (const Benchmark* benchmark : {&a, &b})
    for (const auto& [name, values] : benchmark->counters) names.insert(name);
  for (const std::string& name : names) {
    const std::string whole = a.name + " " + name;
    if (a.counters.count(name) == 0) to.only_b.push_back(whole);
    if (b.counters.count(name) == 0) to.only_a.push_back(whole);
    const std::optional<double> of_a = count_of(a, name), of_b = count_of(b, name);
    if (!of_a || !of_b) continue;
    ++to.counts_compared;
    if (*of_a != *of_b) to.counts.push_back({.name = whole, .a = *of_a, .b = *of_b, .change = Change::changed});
  }
}

/// Returns in what the machines were others, so that times tell nothing of the programs; empty: in nothing.
std::string note_context(const BenchmarkFile& a, const BenchmarkFile& b, Comparison& to) {
  static const std::set<std::string> kOfTheMachine = {"cpu", "num_cpus", "governor", "cpu_scaling_enabled"};
  std::string machine;
  for (const auto& [key, value] : a.context)
    for (const auto& [other_key, other] : b.context) {
      if (key != other_key || value == other) continue;
      to.notices.push_back(shown(fmt::format("{} is {} in A, {} in B", key, value, other)));
      if (kOfTheMachine.count(key) != 0)
        machine += fmt::format("{}{} {} and {}", machine.empty() ? "" : "; ", key, shown(value, 60), shown(other, 60));
    }
  return machine;
}

}  // namespace

double nanoseconds_of(const std::string& unit) {
  const auto found = units_in_ns().find(unit);
  VERISIM_ASSERT(found != units_in_ns().end());
  return found->second;
}

bool goes_by_real_time(const std::string& name) {
  return name.find("/real_time") != std::string::npos || name.find("/manual_time") != std::string::npos;
}

bool looks_like_json(const std::string& path) {
  const std::string text = UserFile(path, path).beginning(256);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string::npos && text[first] == '{';
}

BenchmarkFile read_benchmarks(const std::string& path) {
  const Json j = parsed(path, UserFile(path, path).content());
  if (!j.is_object() || !j.contains("benchmarks") || !j["benchmarks"].is_array())
    fail(ErrorKind::input, "{}: is JSON, but no list of benchmarks; {}", path, kHowToWrite);
  BenchmarkFile file{.origin = {path, "", ""}, .context = {}, .benchmarks = {}};
  if (j.contains("context") && j["context"].is_object()) read_context(j["context"], file);
  try {
    for (const Json& entry : j["benchmarks"]) read_entry(path, entry, file);
  } catch (const Json::exception&) {  // a name that is a number, and so on
    fail(ErrorKind::input, "{}: a benchmark's entry is not as Google Benchmark writes it; {}", path, kHowToWrite);
  }
  if (file.benchmarks.empty())
    fail(ErrorKind::input, "{}: has no benchmark{} in it; {}", path,
         j["benchmarks"].empty() ? "" : "'s repetitions, only what was made of them,", kHowToWrite);
  return file;
}

Comparison compare_benchmarks(const std::string& path_a, const std::string& path_b, const Bounds& bounds) {
  const BenchmarkFile a = read_benchmarks(path_a), b = read_benchmarks(path_b);
  Comparison c{.kind = "benchmarks", .a = a.origin, .b = b.origin};
  const std::string machine = note_context(a, b, c);
  std::vector<TimeSamples> samples;
  for (const Benchmark& of_a : a.benchmarks) {
    const auto of_b = std::find_if(b.benchmarks.begin(), b.benchmarks.end(),
                                   [&](const Benchmark& other) { return other.name == of_a.name; });
    if (of_b == b.benchmarks.end()) {
      c.only_a.push_back(of_a.name);
      continue;
    }
    compare_counts(of_a, *of_b, c);
    const double factor = nanoseconds_of(of_b->unit) / nanoseconds_of(of_a.unit);
    const bool by_real = goes_by_real_time(of_a.name);
    // The one that counts has the benchmark's own name.
    samples.push_back({.name = of_a.name + (by_real ? "" : " (real time)"),
                       .unit = of_a.unit,
                       .a = of_a.real,
                       .b = scaled(of_b->real, factor),
                       .is_judged = by_real && machine.empty()});
    samples.push_back({.name = of_a.name + (by_real ? " (CPU time)" : ""),
                       .unit = of_a.unit,
                       .a = of_a.cpu,
                       .b = scaled(of_b->cpu, factor),
                       .is_judged = !by_real && machine.empty()});
  }
  for (const Benchmark& of_b : b.benchmarks)
    if (std::none_of(a.benchmarks.begin(), a.benchmarks.end(), [&](const Benchmark& o) { return o.name == of_b.name; }))
      c.only_b.push_back(of_b.name);
  c.times = judge_times(samples, {.effect = bounds.effect_interleaved, .alpha = kAlphaApart});
  if (!machine.empty()) {
    c.notices.push_back("times not comparable: " + machine);
    for (TimeFigure& figure : c.times) figure.note = "not comparable: " + machine;
  }
  c.notices.emplace_back(
      "one file was measured after the other: what changed on the machine meanwhile looks like a "
      "change of the program; --programs measures in turns");
  return c;
}

}  // namespace verisim::compare
