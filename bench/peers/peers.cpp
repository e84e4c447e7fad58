// Which engine is faster, and which is more accurate, in one run: this project's exact contacts, MuJoCo, Bullet, ODE
// and FCL push the same pin through the same hole, each under every setting of a grid over its own dials, and of each
// the best is told; then contact queries at recorded poses. `verisim tradeoff --peers` shows the same.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>

#include "bench/peers/measures.hpp"
#include "engine/base/text_table.hpp"

namespace verisim::peers {
namespace {

using nlohmann::ordered_json;

struct Options {
  bool json = false, quick = false;
};

std::vector<Setting> all_settings(std::vector<std::string>& absent) {
  std::vector<Setting> all = settings_here();
  const auto add = [&](const char* engine, const std::vector<Setting>& settings) {
    if (settings.empty()) absent.emplace_back(engine);
    all.insert(all.end(), settings.begin(), settings.end());
  };
  add("MuJoCo (libmujoco-dev)", settings_of_mujoco());
  add("Bullet (libbullet-dev)", settings_of_bullet());
  add("ODE (libode-dev)", settings_of_ode());
  add("FCL (libfcl-dev)", settings_of_fcl());
  return all;
}

std::vector<Insertion> trials(bool quick) {
  std::vector<Insertion> tasks;
  for (const auto& [start, chamfer] : {std::pair(Start::engaged_10mm, 0.0), std::pair(Start::above, 0.002)})
    for (const double clearance : {1e-3, 1e-4, 2e-5}) {
      if (quick && (clearance < 1e-4 || chamfer > 0)) continue;
      tasks.push_back({.clearance = clearance, .start = start, .chamfer = chamfer});
    }
  return tasks;
}

const char* name_of(Start start) {
  return start == Start::above ? "above, chamfered" : "engaged";
}

ordered_json json_of(const SettingResult& r) {
  ordered_json list = ordered_json::array();
  for (const Trial& t : r.trials)
    list.push_back({{"clearance_m", t.task.clearance},
                    {"start", name_of(t.task.start)},
                    {"passed", t.passed},
                    {"overlap_m", t.overlap},
                    {"max_force_N", t.force},
                    {"step_us", {{"p50", t.us}, {"p99", t.us99}}}});
  return {{"engine", r.engine}, {"setting", r.text}, {"trials", list}};
}

ordered_json json_of(const QueryResult& q) {
  return {{"engine", q.engine},
          {"setting", q.text},
          {"query_us", {{"p50", q.us}, {"p99", q.us99}}},
          {"depth_error_m", {{"p50", q.error}, {"p95", q.error95}}},
          {"missed", q.missed},
          {"imagined", q.imagined}};
}

std::string table_of(const std::vector<const SettingResult*>& best) {
  TextTable table(
      {"engine", "start", "clearance mm", "", "deepest mm", "of clearance", "force N", "step us", "99 %", "setting"});
  for (const SettingResult* r : best)
    for (const Trial& t : r->trials)
      table.add({r->engine, name_of(t.task.start), fmt::format("{:g}", 1e3 * t.task.clearance),
                 t.passed ? "passes" : "stays", fmt::format("{:.4f}", 1e3 * t.overlap),
                 fmt::format("{:.3f}", t.overlap / t.task.clearance), fmt::format("{:.0f}", t.force),
                 fmt::format("{:.1f}", t.us), fmt::format("{:.1f}", t.us99), r->text});
  return table.text();
}

std::string table_of(const std::vector<QueryResult>& queries) {
  TextTable table({"engine", "query us", "99 %", "depth off by um", "95 %", "missed %", "imagined %", "setting"});
  for (const QueryResult& q : queries)
    table.add({q.engine, fmt::format("{:.1f}", q.us), fmt::format("{:.1f}", q.us99),
               fmt::format("{:.2f}", 1e6 * q.error), fmt::format("{:.2f}", 1e6 * q.error95),
               fmt::format("{:.1f}", 100 * q.missed), fmt::format("{:.1f}", 100 * q.imagined), q.text});
  return table.text();
}

/// Of each engine the best of the insertions; of those whose contacts hang on a setting, each of these.
std::vector<Setting> asked_for_contacts(const std::vector<Setting>& settings,
                                        const std::vector<const SettingResult*>& best) {
  std::vector<Setting> asked;
  for (const SettingResult* b : best)
    for (const Setting& s : settings)
      if (s.engine == b->engine && s.text == b->text) asked.push_back(s);
  return asked;
}

int run(const Options& o) {
  std::vector<std::string> absent;
  const std::vector<Setting> settings = all_settings(absent);
  std::vector<SettingResult> results;
  for (const Setting& s : settings) results.push_back({s.engine, s.text, {}});
  const std::vector<Insertion> tasks = trials(o.quick);
  for (const Insertion& task : tasks)
    for (std::size_t i = 0; i < settings.size(); ++i) results[i].trials.push_back(run_trial(settings[i], task));
  const std::vector<const SettingResult*> best = best_of_each(results);
  const std::vector<QueryResult> queries = query_all(asked_for_contacts(settings, best));
  if (o.json) {
    ordered_json json{{"searched", ordered_json::array()},
                      {"best", ordered_json::array()},
                      {"queries", ordered_json::array()},
                      {"absent", absent}};
    for (const SettingResult& r : results) json["searched"].push_back(json_of(r));
    for (const SettingResult* r : best) json["best"].push_back(json_of(*r));
    for (const QueryResult& q : queries) json["queries"].push_back(json_of(q));
    std::printf("%s\n", json.dump().c_str());
    return 0;
  }
  std::printf(
      "A hand that leans by half a degree and stands 1 mm beside the axis pushes a pin through a hole, without "
      "friction.\n%zu settings tried; of each engine the one with most passes, then least overlap, then time:\n%s",
      settings.size(), table_of(best).c_str());
  if (queries.empty())
    std::puts("contact queries: the recorded poses (../shared/reference/peers) are not there");
  else
    std::printf("contact queries of these settings at 1000 recorded poses:\n%s", table_of(queries).c_str());
  for (const std::string& engine : absent) std::printf("left out, not installed: %s\n", engine.c_str());
  return 0;
}

}  // namespace

#ifndef VERISIM_HAS_MUJOCO
std::vector<Setting> settings_of_mujoco() {
  return {};
}
#endif
#ifndef VERISIM_HAS_BULLET
std::vector<Setting> settings_of_bullet() {
  return {};
}
#endif
#ifndef VERISIM_HAS_ODE
std::vector<Setting> settings_of_ode() {
  return {};
}
#endif

}  // namespace verisim::peers

int main(int argc, char** argv) {
  CLI::App app{"verisim-peers: other engines on the same insertions and contacts"};
  verisim::peers::Options options;
  app.add_flag("--json", options.json, "One JSON object on stdout");
  app.add_flag("--quick", options.quick, "Two of the six insertions");
  CLI11_PARSE(app, argc, argv);
  return verisim::peers::run(options);
}
