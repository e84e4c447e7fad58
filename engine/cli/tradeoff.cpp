#include <algorithm>
#include <csignal>
#include <cstdio>
#include <memory>

#include "engine/base/error.hpp"
#include "engine/base/hash.hpp"
#include "engine/base/json.hpp"
#include "engine/base/text.hpp"
#include "engine/cli/commands.hpp"
#include "engine/cli/options.hpp"
#include "engine/cli/streams.hpp"
#include "engine/cli/tradeoff_peers.hpp"
#include "engine/cli/tradeoff_sweep.hpp"
#include "engine/contact/query.hpp"
#include "engine/record/output_place.hpp"
#include "engine/session/origin.hpp"
#include "engine/session/recorded_run.hpp"
#include "engine/tradeoff/bounds.hpp"
#include "engine/tradeoff/peers.hpp"

namespace verisim::cli {
namespace {

using tradeoff::Kind;
using tradeoff::Table;

struct TradeoffOptions {
  SweepRequest sweep;
  std::string by, budget, error, simd;
  OutOptions out;
  bool json = false;
  bool peers = false, quick = false;
};

/// What is asked of the table. Read before anything is computed.
struct Question {
  tradeoff::Bounds bounds;
  tradeoff::Kind by = tradeoff::Kind::force;
};

Question question_of(const TradeoffOptions& o) {
  Question question;
  if (!o.by.empty()) question.by = tradeoff::kind_named("--by " + o.by, o.by);
  if (!o.budget.empty()) question.bounds.budget_us = tradeoff::budget_from("--budget " + o.budget, o.budget);
  if (!o.error.empty()) {
    question.bounds.error = tradeoff::error_bound_from("--error " + o.error, o.error, o.by);
    question.by = question.bounds.error->kind;
  }
  return question;
}

constexpr const char* kJsonBegin = "{\"format\":\"verisim-tradeoff\"";

/// Where -o writes, looked at before the work begins.
struct Places {
  std::string json, csv, plot;
};
Places places_in(const std::string& folder, bool force) {
  if (folder.empty()) return {};
  make_folder_of(folder + "/any", folder);
  Places places = {folder + "/tradeoff.json", folder + "/tradeoff.csv", folder + "/tradeoff.svg"};
  (void)check_output({places.json, OutputKind::text, force, kJsonBegin});
  (void)check_output({places.csv, OutputKind::text, force, "setting,"});
  (void)check_output({places.plot, OutputKind::text, force, beginning_of(tradeoff::plot_of({}))});
  return places;
}

void write(const Places& places, const Table& table) {
  if (places.json.empty()) return;
  write_text(places.json, json_text(json_of(table)) + "\n", true);
  write_text(places.csv, csv_of(table), true);
  write_text(places.plot, plot_of(table), true);
}

void print_settings(const Table& table) {
  std::printf("truth: %s\n", shown(table.truth).c_str());
  if (!table.convergence.empty()) std::printf("  %s\n", table.convergence.c_str());
  for (const std::string& note : table.notes) std::printf("note: %s\n", shown(note).c_str());
  std::printf("%s", tradeoff::text_of(table).c_str());
  std::string front;
  for (const std::size_t i : front_of(table.rows, table.by)) front += fmt::format("{}{}", front.empty() ? "" : ", ", i);
  std::printf("front by '%s' (%s): %s\n", tradeoff::kKinds[index_of(table.by)].name,
              tradeoff::kKinds[index_of(table.by)].meaning, front.empty() ? "no setting has it" : front.c_str());
}

/// The settings, if there is a scenario, then the other engines, if they were asked.
void print_table(const Table& table) {
  if (!table.scenario.empty()) print_settings(table);
  if (table.peers_json.empty()) return;
  if (table.scenario.empty())
    for (const std::string& note : table.notes) std::printf("note: %s\n", shown(note).c_str());
  std::printf("%s", tradeoff::text_of_peers(parse_json(table.peers_json)).c_str());
}

bool all_failed(const Table& table) {
  return !table.rows.empty() && std::all_of(table.rows.begin(), table.rows.end(),
                                            [](const tradeoff::Row& row) { return !row.failed.empty(); });
}

/// Nothing where no figure of a bound is a greatest one: `flips` is a share of the repetitions.
bool has_coverage(const tradeoff::Bounds& bounds) {
  return bounds.budget_us || (bounds.error && bounds.error->kind != Kind::flips);
}

Json json_of_setting(const Table& table, std::size_t setting, const tradeoff::Bounds& bounds) {
  return {{"row", setting},
          {"parameters", table.rows[setting].parameters},
          {"coverage", has_coverage(bounds) ? Json(tradeoff::coverage_of(table.repeat)) : Json()}};
}

/// 1 and a line on stderr if no setting keeps the bounds, or none has figures.
int tell(const Table& table, const Question& question, bool as_json) {
  const bool asked = question.bounds.budget_us || question.bounds.error;
  std::optional<std::size_t> setting;
  if (asked) setting = choose(table.rows, question.bounds, question.by);
  if (as_json) {
    Json all = json_of(table);
    if (asked) all["setting"] = setting ? json_of_setting(table, *setting, question.bounds) : Json();
    std::printf("%s\n", json_text(all).c_str());
  } else {
    print_table(table);
    if (setting)
      std::printf("setting: %s (%zu)\n", tradeoff::text_of(table.rows[*setting].parameters).c_str(), *setting);
    if (setting && has_coverage(question.bounds)) std::printf("  %s\n", tradeoff::coverage_text(table.repeat).c_str());
  }
  if (all_failed(table)) {
    print_error(("no setting has figures; the first: " + table.rows.front().failed).c_str());
    return static_cast<int>(ErrorKind::check_failed);
  }
  if (!asked || setting) return 0;
  print_error(("no setting keeps " + tradeoff::text_of(question.bounds) + "; vary more, or ask for less").c_str());
  return static_cast<int>(ErrorKind::check_failed);
}

/// Without a scenario there is nothing to vary and nothing to choose from.
void check_scenario(const TradeoffOptions& o) {
  if (!o.sweep.scenario.empty()) return;
  if (!o.peers) fail(ErrorKind::usage, "SCENARIO is required, but with --peers; see verisim tradeoff --help");
  const SweepRequest& s = o.sweep;
  for (const bool asked : {!s.vary.empty(), !s.truth.empty(), !s.sets.empty(), !s.binds.empty(), s.duration.has_value(),
                           s.threads != 1, !o.budget.empty(), !o.error.empty(), !o.by.empty()})
    if (asked)
      fail(ErrorKind::usage,
           "--vary, --truth, --set, --bind, --duration, --threads, --budget, --error and --by are of a SCENARIO; "
           "name it, or leave them out");
}

Table table_without_scenario(Kind by) {
  Table table;
  table.version = VERISIM_VERSION;
  table.commit = commit();
  table.cpu = cpu_model();
  table.compiler = compiler();
  table.by = by;
  return table;
}

int run_tradeoff(const TradeoffOptions& o) {
  use_simd_target(o.simd);
  check_scenario(o);
  const Question question = question_of(o);
  const std::string peers = o.peers ? peers_program() : "";
  std::optional<Sweep> sweep;
  if (!o.sweep.scenario.empty()) sweep.emplace(o.sweep);
  const Places places = places_in(o.out.path, o.out.force);
  Table table = sweep ? sweep->table(question.by) : table_without_scenario(question.by);
  if (o.peers) {
    const PeersFound found = ask_peers(peers, o.quick, o.sweep.quiet);
    table.peers_json = json_text(found.peers);
    if (!found.note.empty()) table.notes.push_back(found.note);
  }
  write(places, table);
  return tell(table, question, o.json);
}

void add_sweep_options(CLI::App& command, SweepRequest& sweep) {
  command.add_option("--vary", sweep.vary, "KEY=V1,V2,…: a dial (repeatable, crossed); values as --set takes them")
      ->allow_extra_args(false)
      ->take_all();
  command
      .add_option("--truth", sweep.truth,
                  "KEY=VALUE (repeatable): the reference setting, step included (default: hybrid=exact and the finest "
                  "of each dial, at a tenth of the step)")
      ->allow_extra_args(false)
      ->take_all();
  command
      .add_option("--repeat", sweep.repeat,
                  "Repetitions, each with its own seed (default 3): bounds that all N keep hold in N/(N+1) of "
                  "further trials, 95 % with 19")
      ->check(CLI::Range(1, 10000));
  add_seed_option(
      command, [&sweep](std::uint64_t seed) { sweep.seed = seed; },
      "Seed of the sweep, of which the runs' are made (default 1)");
  command.add_option("--set", sweep.sets, "KEY=VALUE: of all settings, as in verisim run")
      ->allow_extra_args(false)
      ->take_all();
  command.add_option("--bind", sweep.binds, "NAME=SOURCE: of all runs, as in verisim run")
      ->allow_extra_args(false)
      ->take_all();
  command.add_option("--duration", sweep.duration, "Simulated seconds of each run")->check(seconds());
  command.add_option("--time-limit", sweep.time_limit_s, "Seconds of wall clock of a run (default: an hour)")
      ->check(seconds());
  command
      .add_option("--memory-limit", sweep.memory_limit_mb, "MiB of memory of a run (default: 80 % of the machine's)")
      ->check(CLI::Range(1, 1 << 30));
  add_cache_option(command, sweep.no_cache);
  command.add_flag("--quiet", sweep.quiet, "No progress");
}

}  // namespace

void add_tradeoff(CLI::App& app, int& exit_code) {
  auto* command =
      app.add_subcommand("tradeoff", "The speed-accuracy trade of a scenario: table, Pareto front, setting to use");
  auto o = std::make_shared<TradeoffOptions>();
  command->add_option("SCENARIO", o->sweep.scenario, "Lua script that describes the scene; not needed for --peers");
  add_sweep_options(*command, o->sweep);
  command->add_option("--budget", o->budget, "200us: the most accurate setting whose median frame keeps that");
  command->add_option("--error", o->error, "0.05N, 0.01mm, 5%: the cheapest setting whose error keeps that");
  command->add_option("--by", o->by,
                      "Error of the front and of --error: wrench, force, force_max, torque, torque_max, position, "
                      "rotation, overlap, work, flips (default: force, or what the unit of --error says)");
  add_speed_options(*command, o->sweep.threads, o->simd);
  auto* peers = command->add_flag("--peers", o->peers,
                                  "MuJoCo, Bullet, ODE and FCL, each at its best of a search, beside this project's "
                                  "methods: the same poses, the same driven insertions (needs verisim-peers)");
  command->add_flag("--quick", o->quick, "Of --peers: one of six insertions, two settings of every grid")->needs(peers);
  add_out_options(*command, o->out, "Folder for tradeoff.json, tradeoff.csv and tradeoff.svg");
  command->add_flag("--json", o->json, "One JSON object on stdout");
  command->footer(
      "Exit code 1: no setting keeps --budget and --error.\n"
      "Example: verisim tradeoff scenarios/peg_in_hole.lua --vary hybrid=off,restore,exact --vary "
      "voxelsize=4.5mm,9mm --duration 2 --repeat 2 --error 0.5N");
  command->callback([=, &exit_code] { exit_code = run_tradeoff(*o); });
}

}  // namespace verisim::cli
