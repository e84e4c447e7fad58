#include "engine/cli/summary.hpp"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "engine/base/error.hpp"
#include "engine/base/hash.hpp"
#include "engine/base/quantile.hpp"
#include "engine/cli/json_text.hpp"

namespace verisim::cli {
namespace {

using nlohmann::ordered_json;

RunFigures::Times times_of(std::vector<std::uint32_t>& ns) {
  if (ns.empty()) return {};
  return {quantile(ns, 0.5), quantile(ns, 0.99), quantile(ns, 1)};
}

ordered_json json_of_figure(const RunFigure::Value& value) {
  if (const auto* times = std::get_if<RunFigures::Times>(&value))
    return {{"p50", times->p50}, {"p99", times->p99}, {"max", times->max}};
  return std::visit(
      [](const auto& v) -> ordered_json {
        if constexpr (std::is_same_v<std::decay_t<decltype(v)>, RunFigures::Times>)
          return {};
        else
          return v;
      },
      value);
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

std::string to_json(const RunFigures& run) {
  ordered_json j;
  for (const RunFigure& figure : run_figures()) j[figure.name] = json_of_figure(figure.value(run));
  j["constraints"] = ordered_json::object();
  for (const auto& [name, frames] : run.constraints) j["constraints"][name] = frames;
  j["measures"] = ordered_json::object();
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

}  // namespace verisim::cli
