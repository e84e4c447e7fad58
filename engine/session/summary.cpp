#include "engine/session/summary.hpp"

#include <algorithm>
#include <filesystem>

#include "engine/base/error.hpp"
#include "engine/base/hash.hpp"
#include "engine/base/json.hpp"
#include "engine/base/quantile.hpp"

namespace verisim {
namespace {

RunFigures::Times times_of(std::vector<std::uint32_t>& ns) {
  if (ns.empty()) return {};
  return {quantile(ns, 0.5), quantile(ns, 0.99), quantile(ns, 1)};
}

Json json_of_figure(const RunFigure::Value& value) {
  if (const auto* times = std::get_if<RunFigures::Times>(&value))
    return {{"p50", times->p50}, {"p99", times->p99}, {"max", times->max}};
  return std::visit(
      [](const auto& v) -> Json {
        if constexpr (std::is_same_v<std::decay_t<decltype(v)>, RunFigures::Times>)
          return {};
        else
          return v;
      },
      value);
}

std::string row_of(const PairFigures& pair) {
  return fmt::format("{:.3g} % of {} contacts of {} and {}, {}{}{}", 100 * pair.fraction(), pair.contacts, pair.first,
                     pair.second, pair.hybrid, pair.why.empty() ? "" : ": ", pair.why);
}

/// Of many pairs those of which voxels answered the most contacts.
std::vector<std::string> rows_of_pairs(const RunFigures& run) {
  constexpr std::size_t kMost = 8;
  std::vector<PairFigures> pairs = run.pairs;
  if (pairs.size() > kMost)
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const PairFigures& a, const PairFigures& b) { return a.by_voxels > b.by_voxels; });
  std::vector<std::string> rows;
  for (std::size_t i = 0; i < std::min(kMost, pairs.size()); ++i) rows.push_back(row_of(pairs[i]));
  if (pairs.size() > kMost)
    rows.push_back(fmt::format("and {} more pairs: /events and --json have them all", pairs.size() - kMost));
  return rows;
}

}  // namespace

const char* name_of(LoopEnd end) {
  switch (end) {
    case LoopEnd::done:
      return "done";
    case LoopEnd::interrupted:
      return "interrupted";
    case LoopEnd::diverged:
      return "diverged";
    case LoopEnd::io_failed:
      return "output failed";
    case LoopEnd::refused:
      return "refused";
  }
  return "";
}

RunFigures figures_of(const Session& session, LoopResult& loop, const std::string& run_file) {
  VERISIM_ASSERT(session.scenario != nullptr && session.simulation != nullptr);
  const Simulation& simulation = *session.simulation;
  RunFigures s;
  s.scenario = std::filesystem::path(session.options.path).filename().string();
  s.run_file = run_file;
  s.outcome = session.scenario->outcome();
  s.state_hash = to_hex(simulation.state_hash());
  s.end = name_of(loop.end);
  s.frames = loop.frame_ns.size();
  s.collision_frames = simulation.collision_frames();
  s.overruns = loop.overruns;
  s.realtime_priority = loop.realtime_priority;
  const Totals& totals = simulation.totals();
  s.collisions = totals.contacts;
  s.by_voxels = totals.by_voxels;
  s.exact_frames = totals.exact_frames;
  s.exact_frames_by_voxels = totals.exact_frames_by_voxels;
  for (const PairAnswers& of : simulation.answers())
    s.pairs.push_back({of.first_name, of.second_name, std::string(of.method), of.contacts, of.by_voxels, of.why});
  s.cache_hits = totals.cache_hits;
  s.cache_misses = totals.cache_misses;
  s.null_misses = totals.null_misses;
  for (std::size_t kind = 1; kind < kConstraintKindNames.size(); ++kind)
    if (totals.constraint_frames[kind] > 0)
      s.constraints.emplace_back(kConstraintKindNames[kind], totals.constraint_frames[kind]);
  s.simulated_s = static_cast<double>(s.frames) * simulation.dt();
  s.wall_s = loop.wall_s;
  s.load_s = session.load_s;
  s.force_max = totals.force_max;
  s.penetration_max = totals.penetration_max;
  s.penetration_source = totals.penetration_source;
  s.frame_ns = times_of(loop.frame_ns);
  s.collision_frame_ns = times_of(loop.collision_frame_ns);
  s.measures = session.scenario->measures();
  return s;
}

std::string fallback_warning(const RunFigures& run) {
  constexpr double kMost = 0.01;  // of the frames with contact
  const double fraction = run.exact_frames > 0
                              ? static_cast<double>(run.exact_frames_by_voxels) / static_cast<double>(run.exact_frames)
                              : 0;
  if (!(fraction > kMost)) return {};
  const auto by_fewer = [](const PairFigures& a, const PairFigures& b) {
    const auto of = [](const PairFigures& pair) { return pair.hybrid == "exact" ? pair.by_voxels : 0; };
    return of(a) < of(b);
  };
  const auto worst = std::max_element(run.pairs.begin(), run.pairs.end(), by_fewer);
  VERISIM_ASSERT(worst != run.pairs.end());
  return fmt::format("hybrid = \"exact\" was asked for, and voxels answered in {:.3g} % of the frames with contact: {}",
                     100 * fraction, worst->why);
}

std::string to_json(const RunFigures& run) {
  Json j;
  for (const RunFigure& figure : run_figures()) j[figure.name] = json_of_figure(figure.value(run));
  j["constraints"] = Json::object();
  for (const auto& [name, frames] : run.constraints) j["constraints"][name] = frames;
  j["pairs"] = Json::array();
  for (const PairFigures& pair : run.pairs)
    j["pairs"].push_back({{"first", pair.first},
                          {"second", pair.second},
                          {"hybrid", pair.hybrid},
                          {"contacts", pair.contacts},
                          {"by_voxels", pair.by_voxels},
                          {"fraction", pair.fraction()},
                          {"why", pair.why}});
  j["measures"] = Json::object();
  for (const Measure& m : run.measures) j["measures"][m.name] = {{"value", m.value}, {"unit", m.unit}};
  return json_text(j);
}

std::string to_table(const RunFigures& run) {
  std::string text;
  const auto row = [&](const char* name, const std::string& value) {
    text += fmt::format("  {:<22}{}\n", name, value);
  };
  const auto times = [](const RunFigures::Times& t) {
    return fmt::format("{:.1f} us median, {:.1f} us 99 %, {:.1f} us max", t.p50 / 1e3, t.p99 / 1e3, t.max / 1e3);
  };
  text += fmt::format("{}: {}\n", run.scenario, run.outcome.empty() ? run.end : run.outcome);
  row("frames", fmt::format("{} ({:.3f} s simulated in {:.3f} s, {:.0f} x real time; loaded in {:.2f} s)", run.frames,
                            run.simulated_s, run.wall_s, run.realtime_factor(), run.load_s));
  row("with contact", fmt::format("{}", run.collision_frames));
  for (const auto& [name, frames] : run.constraints) row(name.c_str(), fmt::format("constraint in {} frames", frames));
  if (run.cache_hits + run.cache_misses > 0)
    row("look-ups", fmt::format("{} memoized, {} recognized ({} of them to no constraint)", run.cache_hits,
                                run.cache_misses, run.null_misses));
  for (const std::string& pair : rows_of_pairs(run)) row("by voxels", pair);
  row("overruns", fmt::format("{}{}", run.overruns, run.realtime_priority ? " (with real-time priority)" : ""));
  row("frame", times(run.frame_ns));
  if (run.collision_frames > 0) row("frame with contact", times(run.collision_frame_ns));
  row("largest force", fmt::format("{:.3g} N", run.force_max));
  row("deepest penetration", fmt::format("{:.3g} mm{}{}", run.penetration_max * 1e3,
                                         run.penetration_source.empty() ? "" : ", by ", run.penetration_source));
  for (const Measure& m : run.measures) row(m.name.c_str(), fmt::format("{:.6g} {}", m.value, m.unit));
  row("state hash", run.state_hash);
  row("run file", run.run_file);
  return text;
}

std::map<std::string, Attribute> to_attributes(const RunFigures& run) {
  const auto count = [](std::uint64_t n) { return static_cast<std::int64_t>(n); };
  std::map<std::string, Attribute> a{{"json", to_json(run)}};
  const auto add = [&](const std::string& name, const auto& value) {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_same_v<Value, RunFigures::Times>) {
      a[name + "_p50"] = count(value.p50);
      a[name + "_p99"] = count(value.p99);
      a[name + "_max"] = count(value.max);
    } else if constexpr (std::is_same_v<Value, std::uint64_t> || std::is_same_v<Value, bool>) {
      a[name] = count(value);
    } else {
      a[name] = value;
    }
  };
  for (const RunFigure& figure : run_figures())
    std::visit([&](const auto& value) { add(figure.name, value); }, figure.value(run));
  for (const Measure& m : run.measures) a["measure " + m.name + " [" + m.unit + "]"] = m.value;
  return a;
}

}  // namespace verisim
