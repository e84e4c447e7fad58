// Which engine is faster, and which is more accurate, in one run: this project's methods, MuJoCo, Bullet, ODE and FCL
// push the same pin through the same hole and are asked for contacts at the same poses, each under every
// setting of a grid over its own dials, and of each the best is told. `verisim tradeoff --peers` runs this.
#include <fmt/format.h>
#include <sys/prctl.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "bench/peers/measures.hpp"
#include "engine/base/error.hpp"
#include "engine/session/origin.hpp"
#include "engine/session/progress_line.hpp"
#include "engine/tradeoff/peers.hpp"

namespace verisim::peers {
namespace {

using nlohmann::ordered_json;

struct Options {
  bool json = false, quick = false, quiet = false;
};

/// With --quick one of the six: engaged, 0.1 mm.
std::vector<Insertion> insertions(bool quick) {
  std::vector<Insertion> tasks;
  for (const auto& [start, chamfer] : {std::pair(Start::engaged_10mm, 0.0), std::pair(Start::above, 0.002)})
    for (const double clearance : {1e-3, 1e-4, 2e-5}) {
      if (quick && (clearance != 1e-4 || chamfer > 0)) continue;
      tasks.push_back({.clearance = clearance, .start = start, .chamfer = chamfer});
    }
  return tasks;
}

/// With --quick the first and the last setting of every grid: what is searched is then said to be so little.
template <typename Setting>
void keep_two(std::vector<Setting>& settings) {
  if (settings.size() > 2) settings.erase(settings.begin() + 1, settings.end() - 1);
}

std::vector<Engine> all_engines(bool quick) {
  std::vector<Engine> engines = engines_here();
  for (Engine (*engine)() : {peer_mujoco, peer_bullet, peer_ode, peer_fcl}) engines.push_back(engine());
  for (Engine& engine : engines)
    if (quick) keep_two(engine.pushes), keep_two(engine.finds);
  return engines;
}

ordered_json json_of(const Interval& i) {
  return {{"median", i.median}, {"low", i.low}, {"high", i.high}};
}

ordered_json json_of(const Pushed& p) {
  ordered_json trials = ordered_json::array();
  double overlap = 0;
  for (const Trial& t : p.trials) {
    if (t.passed) overlap = std::max(overlap, t.overlap);
    trials.push_back({{"clearance_m", t.task.clearance},
                      {"start", t.task.start == Start::above ? "above, chamfered" : "engaged"},
                      {"passed", t.passed},
                      {"overlap_m", t.overlap},
                      {"max_force_N", t.force},
                      {"force_error_N", t.passed ? ordered_json(t.force_error) : ordered_json()},
                      {"step_us", {{"p50", t.us}, {"p99", t.us99}}}});
  }
  const bool any = p.passes() > 0;
  const std::optional<double> force_error = p.force_error();
  std::vector<double> us = p.more_us;
  us.push_back(p.median_us());
  return {{"setting", p.text},
          {"passed", p.passes()},
          {"of", p.trials.size()},
          {"overlap_m", any ? ordered_json(overlap) : ordered_json()},
          {"overlap_of_clearance", any ? ordered_json(p.worst()) : ordered_json()},
          {"force_error_N", force_error ? ordered_json(*force_error) : ordered_json()},
          {"step_us", json_of(tradeoff::interval_of(us))},
          {"trials", trials}};
}

ordered_json json_of(const Found& f, std::size_t poses) {
  return {{"setting", f.text},
          {"poses", poses},
          {"query_us", json_of(f.time())},
          {"query_us_p99", f.us99},
          {"depth_error_m", {{"p50", f.error}, {"p95", f.error95}}},
          {"gap_told", f.gap_seen},
          {"gap_error_m", f.gap_seen > 0 ? ordered_json{{"p95", f.gap_error95}} : ordered_json()},
          {"missed", f.missed},
          {"imagined", f.imagined}};
}

ordered_json row_of(const Engine& engine, const std::vector<Pushed>& pushed, const std::vector<Found>& found,
                    std::size_t poses) {
  if (engine.pushes.empty()) return {{"name", engine.name}, {"version", nullptr}, {"missing", engine.package}};
  ordered_json pushes = ordered_json::array(), finds = ordered_json::array();
  for (const Pushed& p : pushed) pushes.push_back(json_of(p));
  for (const Found& f : found) finds.push_back(json_of(f, poses));
  const ordered_json best_push = pushes[best_of(pushed)];
  const ordered_json best_find = found.empty() ? ordered_json() : finds[best_of(found)];
  return {{"name", engine.name},
          {"version", engine.version},
          {"setting",
           {{"poses", found.empty() ? ordered_json() : best_find["setting"]}, {"insertion", best_push["setting"]}}},
          {"searched", {{"poses", finds}, {"insertion", pushes}}},
          {"poses", best_find},
          {"insertion", best_push}};
}

int run(const Options& o) {
  const ProgressLine line(!o.quiet);
  const Progress say = [&](const std::string& text) { line.say(text.substr(0, 60)); };
  const std::vector<Engine> engines = all_engines(o.quick);
  const Poses poses = poses_in_hole();
  if (poses.are_drawn && !o.quiet)
    std::fputs("note: peg_poses.csv is not beside the sources: the poses of the contact queries are drawn\n", stderr);
  std::vector<std::vector<Pushed>> pushed = push_all(engines, insertions(o.quick), say);
  push_again(engines, pushed, o.quick ? 1 : 3, say);
  const std::vector<std::vector<Found>> found = find_all(engines, poses, o.quick ? 2 : 7, say);
  line.say("");
  ordered_json json{{"format", tradeoff::kPeersFormat},
                    {"format_version", 1},
                    {"version", VERISIM_VERSION},
                    {"commit", commit()},
                    {"quick", o.quick},
                    {"peers", ordered_json::array()}};
  for (std::size_t e = 0; e < engines.size(); ++e)
    json["peers"].push_back(row_of(engines[e], pushed[e], found[e], poses.X_AB.size()));
  std::printf("%s\n", o.json ? json.dump().c_str() : tradeoff::text_of_peers(json["peers"]).c_str());
  return 0;
}

}  // namespace

#ifndef VERISIM_HAS_MUJOCO
Engine peer_mujoco() {
  return {.name = "MuJoCo", .version = "", .package = "libmujoco-dev"};
}
#endif
#ifndef VERISIM_HAS_BULLET
Engine peer_bullet() {
  return {.name = "Bullet", .version = "", .package = "libbullet-dev"};
}
#endif
#ifndef VERISIM_HAS_ODE
Engine peer_ode() {
  return {.name = "ODE", .version = "", .package = "libode-dev"};
}
#endif

}  // namespace verisim::peers

int main(int argc, char** argv) {
  CLI::App app{"verisim-peers: other engines on the same insertions and contacts"};
  verisim::peers::Options options;
  app.add_flag("--json", options.json, "One JSON object on stdout");
  app.add_flag("--quick", options.quick, "One of the six insertions, two settings of every grid");
  app.add_flag("--quiet", options.quiet, "No progress");
  CLI11_PARSE(app, argc, argv);
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);  // who asked is gone: nobody waits for the answer
  try {
    return verisim::peers::run(options);
  } catch (const verisim::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return error.exit_code();
  }
}
