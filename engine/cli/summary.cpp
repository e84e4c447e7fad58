#include "engine/cli/summary.hpp"

#include <filesystem>
#include <nlohmann/json.hpp>

#include "engine/base/hash.hpp"
#include "engine/base/quantile.hpp"

namespace verisim::cli {
namespace {

using nlohmann::ordered_json;

Summary::Times times_of(std::vector<std::uint32_t>& ns) {
  if (ns.empty()) return {};
  return {quantile(ns, 0.5), quantile(ns, 0.99), quantile(ns, 1)};
}

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
  }
  return "";
}

double realtime_factor(const Summary& s) {
  return s.wall_s > 0 ? s.simulated_s / s.wall_s : 0;
}

ordered_json json_of(const Summary::Times& t) {
  return {{"p50", t.p50}, {"p99", t.p99}, {"max", t.max}};
}

}  // namespace

Summary summarize(const Session& session, LoopResult& loop, const std::string& run_file) {
  const Simulation& simulation = *session.simulation;
  Summary s;
  s.scenario = std::filesystem::path(session.options.path).filename().string();
  s.run_file = run_file;
  s.outcome = session.scenario->outcome();
  s.state_hash = to_hex(simulation.state_hash());
  s.end = name_of(loop.end);
  s.frames = loop.frame_ns.size();
  s.collision_frames = simulation.collision_frames();
  s.overruns = loop.overruns;
  s.realtime_priority = loop.realtime_priority;
  const Simulation::Totals& totals = simulation.totals();
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
  s.frame_ns = times_of(loop.frame_ns);
  s.collision_frame_ns = times_of(loop.collision_frame_ns);
  s.measures = session.scenario->measures();
  return s;
}

std::string to_json(const Summary& s) {
  ordered_json j;
  j["scenario"] = s.scenario;
  j["run_file"] = s.run_file;
  j["frames"] = s.frames;
  j["simulated_s"] = s.simulated_s;
  j["wall_s"] = s.wall_s;
  j["load_s"] = s.load_s;
  j["realtime_factor"] = realtime_factor(s);
  j["collision_frames"] = s.collision_frames;
  j["overruns"] = s.overruns;
  j["realtime_priority"] = s.realtime_priority;
  j["collisions"] = s.collisions;
  j["cache_hits"] = s.cache_hits;
  j["cache_misses"] = s.cache_misses;
  j["null_misses"] = s.null_misses;
  j["constraints"] = ordered_json::object();
  for (const auto& [name, frames] : s.constraints) j["constraints"][name] = frames;
  j["max_force_N"] = s.force_max;
  j["max_penetration_m"] = s.penetration_max;
  j["outcome"] = s.outcome;
  j["end"] = s.end;
  j["state_hash"] = s.state_hash;
  j["frame_ns"] = json_of(s.frame_ns);
  j["collision_frame_ns"] = json_of(s.collision_frame_ns);
  j["measures"] = ordered_json::object();
  for (const Measure& m : s.measures) j["measures"][m.name] = {{"value", m.value}, {"unit", m.unit}};
  return j.dump();
}

std::string to_table(const Summary& s) {
  std::string text;
  const auto row = [&](const char* name, const std::string& value) {
    text += fmt::format("  {:<22}{}\n", name, value);
  };
  const auto times = [](const Summary::Times& t) {
    return fmt::format("{:.1f} us median, {:.1f} us 99 %, {:.1f} us max", t.p50 / 1e3, t.p99 / 1e3, t.max / 1e3);
  };
  text += fmt::format("{}: {}\n", s.scenario, s.outcome.empty() ? s.end : s.outcome);
  row("frames", fmt::format("{} ({:.3f} s simulated in {:.3f} s, {:.0f} x real time; loaded in {:.2f} s)", s.frames,
                            s.simulated_s, s.wall_s, realtime_factor(s), s.load_s));
  row("with contact", fmt::format("{}", s.collision_frames));
  for (const auto& [name, frames] : s.constraints) row(name.c_str(), fmt::format("constraint in {} frames", frames));
  if (s.cache_hits + s.cache_misses > 0)
    row("look-ups", fmt::format("{} memoized, {} recognized ({} of them to no constraint)", s.cache_hits,
                                s.cache_misses, s.null_misses));
  row("overruns", fmt::format("{}{}", s.overruns, s.realtime_priority ? " (with real-time priority)" : ""));
  row("frame", times(s.frame_ns));
  if (s.collision_frames > 0) row("frame with contact", times(s.collision_frame_ns));
  row("largest force", fmt::format("{:.3g} N", s.force_max));
  row("deepest penetration", fmt::format("{:.3g} mm", s.penetration_max * 1e3));
  for (const Measure& m : s.measures) row(m.name.c_str(), fmt::format("{:.6g} {}", m.value, m.unit));
  row("state hash", s.state_hash);
  row("run file", s.run_file);
  return text;
}

std::map<std::string, Attribute> to_attributes(const Summary& s) {
  const auto count = [](std::uint64_t n) { return static_cast<std::int64_t>(n); };
  std::map<std::string, Attribute> a{{"scenario", s.scenario},
                                     {"frames", count(s.frames)},
                                     {"simulated_s", s.simulated_s},
                                     {"wall_s", s.wall_s},
                                     {"load_s", s.load_s},
                                     {"realtime_factor", realtime_factor(s)},
                                     {"collision_frames", count(s.collision_frames)},
                                     {"overruns", count(s.overruns)},
                                     {"cache_hits", count(s.cache_hits)},
                                     {"cache_misses", count(s.cache_misses)},
                                     {"null_misses", count(s.null_misses)},
                                     {"collisions", count(s.collisions)},
                                     {"max_force_N", s.force_max},
                                     {"max_penetration_m", s.penetration_max},
                                     {"outcome", s.outcome},
                                     {"end", s.end},
                                     {"state_hash", s.state_hash},
                                     {"json", to_json(s)}};
  const auto add_times = [&](const std::string& name, const Summary::Times& t) {
    a[name + "_p50"] = count(t.p50);
    a[name + "_p99"] = count(t.p99);
    a[name + "_max"] = count(t.max);
  };
  add_times("frame_ns", s.frame_ns);
  add_times("collision_frame_ns", s.collision_frame_ns);
  for (const Measure& m : s.measures) a["measure " + m.name + " [" + m.unit + "]"] = m.value;
  return a;
}

}  // namespace verisim::cli
