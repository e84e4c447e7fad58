#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "engine/base/error.hpp"
#include "engine/base/json.hpp"
#include "engine/batch/workers.hpp"
#include "engine/cli/commands.hpp"
#include "engine/cli/options.hpp"
#include "engine/cli/scenarios_folder.hpp"
#include "engine/cli/stability_output.hpp"
#include "engine/contact/query.hpp"
#include "engine/session/interrupts.hpp"
#include "engine/session/prepared_parts.hpp"
#include "engine/session/progress_line.hpp"
#include "engine/session/session.hpp"
#include "engine/stability/extremes.hpp"
#include "engine/stability/ledger.hpp"
#include "engine/stability/maps.hpp"

namespace verisim::cli {
namespace {

namespace fs = std::filesystem;
using stability::Row;
using stability::RowKind;
using stability::Task;

/// The scenarios that are shipped, but for what others require.
constexpr std::array kShipped = {
    "assembly",    "bubble_stickiness", "declared", "everything", "head_tracking", "iso_fit",
    "peg_in_hole", "peg_in_hole_step",  "pins",     "reach",      "robot_gain",    "robot_restart",
    "robot_walk",  "robot_wall",        "seats",    "slide",      "stack",         "tray"};
constexpr double kShort = 2;  // s, of a shipped scenario unless all is asked for

struct StabilityOptions {
  std::string scenario, scenarios;
  OutOptions out;
  std::vector<std::string> only, sets, binds;
  std::optional<double> duration;
  std::optional<std::uint64_t> seed;
  unsigned jobs = 0, threads = 1;
  std::string simd;
  bool all = false;
  bool json = false;
  bool quiet = false;
};

std::unique_ptr<Inputs> inputs_of(const ScenarioOptions& options) {
  const fs::path folder = fs::path(options.path).parent_path();
  return std::make_unique<Inputs>(
      Inputs::live(folder.empty() ? "." : folder.string(), named_paths(options), prepared_parts()));
}

ScenarioOptions ledger_options(const StabilityOptions& o, const std::string& path) {
  ScenarioOptions options;
  options.path = path;
  options.sets = split_pairs("--set", o.sets);
  options.binds = split_pairs("--bind", o.binds);
  options.seed = o.seed;
  options.duration = o.duration;
  if (o.scenario.empty() && !o.all && !o.duration) options.duration = kShort;
  return options;
}

/// The energy of a scenario's run.
Row ledger_of(const ScenarioOptions& options, unsigned threads) {
  const fs::path path(options.path);
  std::unique_ptr<stability::EnergyAudit> audit;
  Session session = open_session(options, inputs_of(options), threads, true,
                                 [&](const Scene& scene) { audit = std::make_unique<stability::EnergyAudit>(scene); });
  Simulation& simulation = *session.simulation;
  audit->start(simulation);
  std::string told;
  while (simulation.frame() < simulation.frames_planned() && !session.scenario->finished()) {
    simulation.step();
    for (const Event& event : simulation.events())
      if (event.kind == "energy" && told.empty()) told = event.text;
    simulation.clear_events();
    audit->look(simulation);
  }
  Row row = audit->row(path.filename().string(), simulation);
  if (!told.empty()) row.why += (row.why.empty() ? "" : "; ") + told;
  return row;
}

void add_ledgers(const StabilityOptions& o, std::vector<Task>& tasks) {
  std::vector<std::string> paths;
  if (!o.scenario.empty()) {
    std::error_code error;
    if (!fs::exists(o.scenario, error))
      fail(ErrorKind::input, "{}: there is no such file; name a scenario", o.scenario);
    paths = {end_of_links(o.scenario)};
  } else {
    const std::string folder = o.scenarios.empty() ? scenarios_folder() : o.scenarios;
    std::error_code error;
    if (!fs::is_directory(folder, error))
      fail(ErrorKind::input, "{}: there is no such folder; name that of the shipped scenarios", folder);
    for (const char* name : kShipped) paths.push_back(fmt::format("{}/{}.lua", folder, name));
  }
  for (const std::string& path : paths) {
    tasks.push_back({"", RowKind::ledger, fs::path(path).filename().string(), false,
                     [options = ledger_options(o, path), threads = o.threads] { return ledger_of(options, threads); }});
  }
}

std::vector<Task> tasks_of(const StabilityOptions& o) {
  const auto wanted = [&](const std::string& what) {
    return o.only.empty() || std::find(o.only.begin(), o.only.end(), what) != o.only.end();
  };
  std::vector<Task> all, tasks;
  for (Task& task : stability::map_tasks())
    if (wanted("maps") || wanted(task.map)) all.push_back(std::move(task));
  if (wanted("extremes"))
    for (Task& task : stability::extreme_tasks()) all.push_back(std::move(task));
  for (Task& task : all)
    if (o.all || !task.is_long) tasks.push_back(std::move(task));
  if (wanted("ledgers")) add_ledgers(o, tasks);
  return tasks;
}

/// A row whose worker did not answer: refused input, or a crash, which is a failure of ours.
Row lost(const Task& task, const batch::WorkerEnd& end) {
  Row row;
  row.what = task.what;
  row.outcome = stability::Outcome::refused;
  row.theory = "an answer";
  row.holds = false;
  row.why = end.exit_code > 0 && !end.out_of_memory ? end.last_words : batch::why_no_answer(end, {});
  return row;
}

/// Each row in a process of its own, so that one that crashes is a row. Their order is that of the tasks.
std::vector<StabilityRow> compute(std::vector<Task> tasks, const StabilityOptions& o) {
  std::vector<StabilityRow> rows(tasks.size());
  for (std::size_t i = 0; i < tasks.size(); ++i) rows[i].task = std::move(tasks[i]);
  batch::Workers workers(o.jobs > 0 ? o.jobs : batch::cores(), {},
                         [&](std::uint64_t i) { return json_text(cli::json_of(rows[i].task.compute())); });
  const ProgressLine line(!o.quiet);
  std::size_t begun = 0, done = 0;
  while (done < rows.size()) {
    while (begun < rows.size() && workers.is_free()) workers.begin(begun++);
    for (const batch::WorkerEnd& end : workers.wait(0.2)) {
      StabilityRow& row = rows[end.run];
      row.row = end.exit_code == 0 ? row_of(parse_json(end.answer)) : lost(row.task, end);
      row.cpu_s = end.user_s + end.system_s;
      ++done;
    }
    if (was_interrupted()) fail(ErrorKind::interrupted, "interrupted");
    line.say(fmt::format("{} of {} rows", done, rows.size()));
  }
  return rows;
}

/// Error(usage): what only ledgers use was said, and there will be none.
void check_ledgers_wanted(const StabilityOptions& o) {
  if (o.only.empty() || std::find(o.only.begin(), o.only.end(), "ledgers") != o.only.end()) return;
  for (const auto& [is_said, what] : {std::pair{!o.scenario.empty(), "SCENARIO"},
                                      {!o.sets.empty(), "--set"},
                                      {!o.binds.empty(), "--bind"},
                                      {o.seed.has_value(), "--seed"},
                                      {o.threads != 1, "--threads"},
                                      {o.duration.has_value(), "--duration"},
                                      {!o.scenarios.empty(), "--scenarios"}})
    if (is_said) fail(ErrorKind::usage, "{} is for ledgers, and --only leaves them out; add --only ledgers", what);
}

/// Of one scenario that was named: what it refuses is this command's error, not a row. It is opened and not run.
void check_scenario(const StabilityOptions& o, const std::vector<Task>& tasks) {
  const bool wanted = std::any_of(tasks.begin(), tasks.end(), [](const Task& t) { return t.kind == RowKind::ledger; });
  if (o.scenario.empty() || !wanted) return;
  const ScenarioOptions options = ledger_options(o, end_of_links(o.scenario));
  (void)open_session(options, inputs_of(options), 1, true);
}

int run_stability(const StabilityOptions& o) {
  use_simd_target(o.simd);
  check_ledgers_wanted(o);
  if (!o.out.path.empty()) check_folder(o.out.path, o.out.force);
  std::vector<Task> tasks = tasks_of(o);
  check_scenario(o, tasks);
  const std::vector<StabilityRow> rows = compute(std::move(tasks), o);
  if (!o.out.path.empty()) write_folder(o.out.path, o.out.force, rows);
  std::printf("%s%s", o.json ? json_text(json_of(rows)).c_str() : tables_of(rows).c_str(), o.json ? "\n" : "");
  return broken_promises(rows).empty() ? 0 : static_cast<int>(ErrorKind::check_failed);
}

}  // namespace

void add_stability(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand(
      "stability", "Where the simulation is stable, beside the bounds of theory; extremes; who gave a run its energy");
  auto o = std::make_shared<StabilityOptions>();
  command->add_option("scenario", o->scenario,
                      "Scenario whose energy is accounted for (default: all that are shipped)");
  add_out_options(*command, o->out, "Folder for stability.json, CSV files and pictures of the maps");
  std::vector<std::string> parts = {"maps", "extremes", "ledgers"};
  for (const stability::MapDescription& map : stability::map_descriptions()) parts.push_back(map.name);
  command->add_option("--only", o->only, "Only all maps, one of them, extremes or ledgers (repeatable)")
      ->allow_extra_args(false)
      ->check(CLI::IsMember(parts));
  command->add_option("--set", o->sets, "Scenario parameter, KEY=VALUE (repeatable)")->allow_extra_args(false);
  command->add_option("--bind", o->binds, "NAME=SOURCE, as in verisim run (repeatable)")->allow_extra_args(false);
  add_seed_option(
      *command, [=](std::uint64_t seed) { o->seed = seed; }, "Seed of each scenario (default: its own)");
  command->add_option("--duration", o->duration, "Simulated time of each scenario, s (default: 2 of a shipped one)")
      ->check(seconds());
  command->add_option("--scenarios", o->scenarios, "Folder of the shipped scenarios (else found beside the program)");
  command->add_option("--jobs", o->jobs, "Rows computed at once (default: all cores); the same bits")
      ->check(CLI::Range(1U, 4096U));
  add_speed_options(*command, o->threads, o->simd);
  command->add_flag("--long", o->all, "All rows, scenarios to their end: many minutes");
  command->add_flag("--json", o->json, "One JSON object on stdout");
  command->add_flag("--quiet", o->quiet, "No progress");
  command->footer(
      "Exit code 1 if a promise does not hold: a bound beyond its tolerance, a cell that contradicts theory, a ledger\n"
      "that does not close, an extreme that fails and no event of its run says so, a row without an answer. An "
      "extreme\n"
      "that fails and is told of ('held: no', with the event as 'why') is no failure of the command: exit code 0.\n"
      "Example: verisim stability --only ledgers scenarios/stack.lua");
  command->callback([=, &exit_code] { exit_code = run_stability(*o); });
}

}  // namespace verisim::cli
