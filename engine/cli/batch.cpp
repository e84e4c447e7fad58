#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "engine/base/error.hpp"
#include "engine/base/hash.hpp"
#include "engine/base/json.hpp"
#include "engine/base/text.hpp"
#include "engine/base/user_file.hpp"
#include "engine/batch/conditions.hpp"
#include "engine/batch/design.hpp"
#include "engine/batch/folder.hpp"
#include "engine/batch/index.hpp"
#include "engine/batch/summary.hpp"
#include "engine/batch/workers.hpp"
#include "engine/cli/batch_merge.hpp"
#include "engine/cli/batch_output.hpp"
#include "engine/cli/batch_words.hpp"
#include "engine/cli/batch_worker.hpp"
#include "engine/cli/commands.hpp"
#include "engine/cli/options.hpp"
#include "engine/cli/streams.hpp"
#include "engine/contact/query.hpp"
#include "engine/session/interrupts.hpp"
#include "engine/session/origin.hpp"
#include "engine/session/prepared_parts.hpp"
#include "engine/session/progress_line.hpp"
#include "engine/session/session.hpp"
#include "engine/session/stop_watch.hpp"

namespace verisim::cli {
namespace {

namespace fs = std::filesystem;
using batch::Answer;
using batch::Cell;
using batch::Design;

struct BatchOptions {
  std::string scenario, out, design_file, keep = "summary", shard, simd;
  std::vector<std::string> sets, binds, vary, random;
  std::optional<double> duration;
  std::optional<double> time_limit;
  std::uint64_t memory_limit_mb = 0;
  std::uint64_t seed = 1, repeat = 1;
  unsigned jobs = 0, threads = 1;
  bool measure = false, no_cache = false, retry_failed = false, json = false, quiet = false;
};

BatchRunOptions::Keep keep_of(const std::string& word) {
  if (word == "all") return BatchRunOptions::Keep::all;
  return word == "failed" ? BatchRunOptions::Keep::failed : BatchRunOptions::Keep::summary;
}

[[noreturn]] void refuse_gone(const std::string& name) {
  fail(ErrorKind::input,
       "{}: is gone since the batch began: its runs would not be of one scenario; put it back, or name another folder "
       "with -o",
       shown(name));
}

/// One batch: its design, its folder, its rows.
class Batch {
 public:
  explicit Batch(const BatchOptions& o);
  /// Computes what the index lacks.
  void compute();
  void report();
  [[nodiscard]] int exit_code() { return exit_code_of(*index_, folder_->path()); }

 private:
  Design read_design();
  void check_inputs();
  void say_what_was_not_kept();
  [[nodiscard]] Json manifest() const;
  [[nodiscard]] std::string work(std::uint64_t run) const;
  void take(const batch::WorkerEnd& end);
  [[nodiscard]] Answer answer_to(const batch::WorkerEnd& end) const;
  [[nodiscard]] batch::RowHead head_of(const batch::Point& point, const Answer& answer) const;
  [[nodiscard]] std::string name_of(const batch::Point& point) const;
  void add_row(const batch::Point& point, const Answer& answer);
  void say(const std::vector<std::string>& lines);
  void find_conditions(std::uint64_t wanted);
  void forget_failed();
  void close_index();
  void say_progress(std::uint64_t done, std::uint64_t all);

  const BatchOptions& o_;
  BatchRunOptions run_options_;
  std::string scenario_sha256_;
  std::vector<ParameterDeclaration> declared_;
  Design design_;
  batch::Layout layout_;
  unsigned jobs_ = 1;
  batch::WorkerLimits limits_;
  std::unique_ptr<batch::Folder> folder_;
  std::unique_ptr<batch::Index> index_;
  std::uint64_t failed_now_ = 0;
  batch::Conditions conditions_;  ///< of this call
  RunWords words_;
  StopWatch watch_;
  double wall_s_ = 0;
  std::unique_ptr<ProgressLine> line_;
};

Batch::Batch(const BatchOptions& o) : o_(o) {
  if (o.scenario.empty()) fail(ErrorKind::usage, "SCENARIO is required; see verisim batch --help");
  use_simd_target(o.simd);
  ScenarioOptions& scenario = run_options_.scenario;
  scenario.path = end_of_links(o.scenario);
  scenario.sets = split_pairs("--set", o.sets);
  scenario.binds = split_pairs("--bind", o.binds);
  scenario.duration = o.duration;
  run_options_.threads = o.threads;
  run_options_.measure = o.measure;
  run_options_.store = prepared_parts(!o.no_cache);
  run_options_.keep = keep_of(o.keep);
  run_options_.folder = o.out.empty() ? "runs/" + fs::path(scenario.path).stem().string() + "-batch" : o.out;
  design_ = read_design();
  layout_ = layout_of_runs(declared_, o.measure);
  jobs_ = o.jobs > 0 ? o.jobs : batch::cores();
  constexpr double kHour = 3600;
  constexpr std::uint64_t kMebibyte = std::uint64_t{1} << 20;
  limits_.time_s = o.time_limit.value_or(kHour);
  limits_.memory_bytes = o.memory_limit_mb > 0 ? o.memory_limit_mb * kMebibyte : batch::physical_memory() / 10 * 8;
  folder_ = std::make_unique<batch::Folder>(run_options_.folder, manifest());
  index_ = std::make_unique<batch::Index>(batch::index_of(folder_->path()), layout_, program_version());
  index_->expect_input(fs::path(scenario.path).filename().string(), scenario_sha256_);
  check_inputs();
}

/// Error(input) if a file that runs before this call read has another content now, or is gone.
void Batch::check_inputs() {
  const ScenarioOptions& scenario = run_options_.scenario;
  Inputs inputs = Inputs::live(fs::path(scenario.path).parent_path().string(), named_paths(scenario));
  for (const std::string& name : index_->inputs()) {
    if (!inputs.exists(name)) refuse_gone(name);
    index_->expect_input(name, sha256(inputs.read(name)));
  }
}

Design Batch::read_design() {
  const ScenarioOptions& scenario = run_options_.scenario;
  Inputs inputs = Inputs::live(fs::path(scenario.path).parent_path().string(), named_paths(scenario));
  DeclaredParameters parameters(scenario, inputs);
  declared_ = parameters.all();
  scenario_sha256_ = sha256(inputs.read(fs::path(scenario.path).filename().string()));
  batch::DesignRequest request;
  request.vary = o_.vary;
  request.random = o_.random;
  request.design_name = o_.design_file;
  if (!o_.design_file.empty()) request.design_content = UserFile(o_.design_file, o_.design_file).content();
  for (const auto& [key, value] : scenario.sets) request.set_keys.push_back(key);
  const bool has_seed = std::any_of(declared_.begin(), declared_.end(), [](const auto& p) { return p.name == "seed"; });
  request.seed_is_a_parameter = has_seed;
  request.repeat = o_.repeat;
  request.seed = o_.seed;
  request.shard = o_.shard;
  return batch::make_design(request, [&](const std::string& option, const std::string& key, const std::string& text) {
    return batch::cell_of(parse_json(parameters.value_of(key, text, option)));
  });
}

Json Batch::manifest() const {
  Json design = batch::to_json(design_);
  design["set"] = Json::object();
  for (const ParameterDeclaration& p : declared_)
    for (const auto& [key, value] : run_options_.scenario.sets)
      if (key == p.name) design["set"][key] = parse_json(p.value_json);
  design["bind"] = Json::object();
  for (const auto& [name, source] : run_options_.scenario.binds) design["bind"][name] = source;
  design["duration"] = o_.duration ? Json(*o_.duration) : Json();
  design["measure"] = o_.measure;
  const bool whole = design_.shard.of == 1;
  return {{"format", "verisim-batch"},
          {"format_version", batch::kManifestFormat},
          {"version", VERISIM_VERSION},
          {"commit", commit()},
          {"scenario", run_options_.scenario.path},
          {"scenario_sha256", scenario_sha256_},
          {"seed", design_.seed},
          {"shard", whole ? Json() : Json{{"index", design_.shard.index}, {"of", design_.shard.of}}},
          {"design", design},
          {"runs", design_.runs()},
          {"groups", design_.group_keys()},
          {"machine",
           {{"cpu", cpu_model()},
            {"cores", batch::cores()},
            {"memory_bytes", batch::physical_memory()},
            {"compiler", compiler()}}}};
}

/// Parameters as the design has them; the others as the run used them or, if it never began, as they are declared.
batch::RowHead Batch::head_of(const batch::Point& point, const Answer& answer) const {
  batch::RowHead head{.run = point.run, .seed = point.seed, .parameters = {}};
  const std::vector<std::string> keys = design_.keys();
  for (const ParameterDeclaration& p : declared_) {
    const auto used = answer.parameters.find(p.name);
    Cell cell = used != answer.parameters.end() ? used->second : batch::cell_of(parse_json(p.value_json));
    for (std::size_t i = 0; i < keys.size(); ++i)
      if (keys[i] == p.name) cell = point.values[i].cell;
    head.parameters.push_back(std::move(cell));
  }
  return head;
}

/// Runs that are done are not done again, so their files are not there even if they are to be kept now.
void Batch::say_what_was_not_kept() {
  using Keep = BatchRunOptions::Keep;
  if (run_options_.keep == Keep::summary || o_.quiet) return;
  const std::uint64_t runs = index_->count_without_run_file(run_options_.keep == Keep::all);
  if (runs == 0) return;
  std::fprintf(stderr,
               "note: %s: %s of the runs that were done before %s no run file: --keep is of those that this call does; "
               "name another folder with -o for all\n",
               shown(folder_->path()).c_str(), fmt::format("{}", runs).c_str(), runs == 1 ? "has" : "have");
}

/// In the worker.
std::string Batch::work(std::uint64_t run) const {
  const batch::Point point = design_.point(run);
  ScenarioOptions scenario = run_options_.scenario;
  scenario.seed = point.seed;
  const std::vector<std::string> keys = design_.keys();
  for (std::size_t i = 0; i < keys.size(); ++i) scenario.sets.emplace_back(keys[i], point.values[i].text);
  return to_text(answer_of_run(run_options_, scenario, run));
}

Answer Batch::answer_to(const batch::WorkerEnd& end) const {
  if (end.exit_code == static_cast<int>(ErrorKind::io))
    fail(ErrorKind::io, "run {}: {}", end.run, shown(end.last_words));
  Answer answer;
  if (end.exit_code == 0) {
    answer = batch::answer_of(end.answer);
  } else {
    answer.answered = false;
    answer.status = end.timed_out ? "timeout" : end.out_of_memory ? "memory" : "failed";
    answer.error = batch::why_no_answer(end, limits_);
  }
  answer.timing["process_s"] = end.wall_s;
  answer.timing["user_s"] = end.user_s;
  answer.timing["system_s"] = end.system_s;
  answer.timing["memory_bytes"] = batch::cell_of(end.memory_bytes);
  answer.timing["answered"] = std::int64_t{answer.answered ? 1 : 0};
  batch::add_conditions(answer, conditions_);
  return answer;
}

/// run 3 (clearance=0.001, seed 7)
std::string Batch::name_of(const batch::Point& point) const {
  std::string at;
  const std::vector<std::string> keys = design_.keys();
  for (std::size_t i = 0; i < keys.size(); ++i)
    at += fmt::format("{}={}, ", keys[i], batch::plain_text(point.values[i].cell));
  return fmt::format("run {} ({}seed {})", point.run, shown(at, 200), point.seed);
}

/// Error(input) if the run is none of this batch: a file was changed, or is gone, since the batch began.
void Batch::add_row(const batch::Point& point, const Answer& answer) {
  const fs::path folder = fs::path(run_options_.scenario.path).parent_path();
  if (answer.status != "done" && answer.answered)
    for (const std::string& name : index_->inputs())
      if (!identity_of((folder / name).string()) && !identity_of(name)) refuse_gone(name);
  try {
    index_->add(head_of(point, answer), answer);
  } catch (const Error& error) {
    fail(error.kind(), "{}: {}", name_of(point), error.what());
  }
}

void Batch::say(const std::vector<std::string>& lines) {
  if (o_.quiet || lines.empty()) return;
  line_->say("");
  for (const std::string& line : lines) std::fprintf(stderr, "%s\n", line.c_str());
}

void Batch::take(const batch::WorkerEnd& end) {
  const batch::Point point = design_.point(end.run);
  Answer answer = answer_to(end);
  const bool done = answer.status == "done";
  using Keep = BatchRunOptions::Keep;
  if (run_options_.keep == Keep::summary || (run_options_.keep == Keep::failed && done))
    remove_run_files(run_options_, end.run);
  const std::string file = batch::Folder::run_file(end.run);
  answer.figures["run_file"] = identity_of(folder_->file(file)) ? file : "";
  add_row(point, answer);
  if (end.exit_code == 0) say(words_.take(end.run, name_of(point), end.last_words));
  if (done) return;
  ++failed_now_;
  if (o_.quiet) return;
  line_->say("");
  std::fprintf(stderr, "%s: %s: %s\n", name_of(point).c_str(), answer.status.c_str(), answer.error.c_str());
}

std::string time_text(double seconds) {
  if (seconds < 100) return fmt::format("{:.0f} s", seconds);
  if (seconds < 6000) return fmt::format("{:.0f} min", seconds / 60);
  return fmt::format("{:.1f} h", seconds / 3600);
}

void Batch::say_progress(std::uint64_t done, std::uint64_t all) {
  if (!line_->is_shown()) return;
  const double left = watch_.seconds() / static_cast<double>(done) * static_cast<double>(all - done);
  line_->say(fmt::format("  {} of {} runs, {} not done, {} left", done, all, failed_now_, time_text(left)));
}

/// What the times of this call's runs hang on. @param wanted how many they are
void Batch::find_conditions(std::uint64_t wanted) {
  conditions_ = {.jobs = static_cast<unsigned>(std::min<std::uint64_t>(jobs_, std::max<std::uint64_t>(wanted, 1))),
                 .threads = o_.threads,
                 .cores = batch::cores(),
                 .recorded = run_options_.measure || run_options_.keep != BatchRunOptions::Keep::summary,
                 .simd = o_.simd.empty() ? simd_targets().front() : o_.simd,
                 .cpu = cpu_model()};
}

/// The CSVs first: while they are there the batch counts as ended.
void Batch::forget_failed() {
  if (index_->count_unanswered() == 0) return;
  std::error_code error;
  for (const char* name : {"index.csv", "timing.csv"})
    if (fs::remove(folder_->file(name), error); error) refuse_write(folder_->file(name), error.message());
  index_->forget_unanswered();
}

/// The CSVs, and what the times hang on into batch.json.
void Batch::close_index() {
  index_->write_csv(folder_->path());
  Json manifest = batch::read_manifest(folder_->path());
  manifest[batch::kComputed] = batch::conditions_json(*index_);
  folder_->write_manifest(manifest);
}

void Batch::compute() {
  if (o_.retry_failed) forget_failed();
  say_what_was_not_kept();
  const InterruptScope until_the_index_is_whole;
  line_ = std::make_unique<ProgressLine>(!o_.quiet);
  const std::vector<std::uint64_t> there = index_->runs(design_.runs());
  std::size_t known = 0;
  std::uint64_t next = design_.shard.index - 1, done = 0;
  const std::uint64_t all = design_.runs(), wanted = design_.runs_of_shard() - there.size();
  find_conditions(wanted);
  const auto skip_known = [&] {
    while (known < there.size() && next == there[known]) {
      ++known;
      next += design_.shard.of;
    }
  };
  batch::Workers workers(jobs_, limits_, [this](std::uint64_t run) { return work(run); });
  while (!was_interrupted()) {
    for (skip_known(); next < all && workers.is_free(); skip_known()) {
      workers.begin(next);
      next += design_.shard.of;
    }
    if (workers.are_idle()) break;
    constexpr double kLook = 1;  // s
    for (const batch::WorkerEnd& end : workers.wait(kLook)) {
      take(end);
      say_progress(++done, wanted);
    }
  }
  line_->say("");
  if (was_interrupted()) fail(ErrorKind::interrupted, "{}: interrupted; the same command goes on", folder_->path());
  std::error_code ignored;
  fs::remove(folder_->file("runs"), ignored);  // if nothing was kept in it
  close_index();
  say(words_.rest());
  wall_s_ = watch_.seconds();
}

/// Names of the columns of parameters.
std::vector<std::string> columns_of(const std::vector<ParameterDeclaration>& declared, const batch::Layout& layout,
                                    const std::vector<std::string>& keys) {
  std::vector<std::string> columns;
  for (const std::string& key : keys)
    for (std::size_t i = 0; i < declared.size(); ++i)
      if (declared[i].name == key) columns.push_back(layout.parameters[i].name);
  return columns;
}

void Batch::report() {
  if (o_.quiet && !o_.json) return;
  const batch::Summary summary =
      batch::summarize(*index_, columns_of(declared_, layout_, design_.group_keys()), design_.seed);
  if (!o_.json) {
    std::printf("%s", table_of(*index_, summary, folder_->path()).c_str());
    return;
  }
  Json json = json_of(*index_, summary, folder_->path());
  json["wall_s"] = wall_s_;
  json["jobs"] = jobs_;
  std::printf("%s\n", json_text(json).c_str());
}

void add_design_options(CLI::App& command, BatchOptions& o) {
  command.add_option("--vary", o.vary, "KEY=V1,V2,…: a grid (repeatable, crossed); values as --set takes them")
      ->allow_extra_args(false)
      ->take_all();
  command.add_option("--design", o.design_file, "CSV with a row per run; columns are parameters, and seed");
  command
      .add_option("--random", o.random,
                  "N KEY=LOW..HIGH …: N draws; also uniform:LOW:HIGH, normal:MEAN:SD, zone:H7:25mm (a diameter)")
      ->expected(1, 1000)
      ->take_all();
  command.add_option("--repeat", o.repeat, "Repetitions, each with its own seed")
      ->check(CLI::Range(std::uint64_t{0}, batch::kRunsMax));
  command.add_option("--shard", o.shard, "I/N: the I-th of N parts of the runs; 'batch merge' joins them");
  add_seed_option(
      command, [&o](std::uint64_t seed) { o.seed = seed; },
      "Seed of the batch, of which the runs' are made (default 1)");
  command.add_option("--set", o.sets, "KEY=VALUE: of all runs, as in verisim run")->allow_extra_args(false)->take_all();
  command.add_option("--bind", o.binds, "NAME=SOURCE: of all runs, as in verisim run")
      ->allow_extra_args(false)
      ->take_all();
  command.add_option("--duration", o.duration, "Simulated seconds of each run")->check(seconds());
}

/// --random takes all words behind it: the scenario may be the last of them.
void find_scenario(BatchOptions& o) {
  if (!o.scenario.empty() || o.random.empty()) return;
  const std::string& last = o.random.back();
  if (last.find('=') != std::string::npos || last.find_first_not_of("0123456789") == std::string::npos) return;
  o.scenario = last;
  o.random.pop_back();
}

void add_work_options(CLI::App& command, BatchOptions& o) {
  command
      .add_option("-o,--out", o.out,
                  "Folder to write, or to go on in if it holds the same design (default: runs/SCENARIO-batch)")
      ->check(named());
  command.add_option("--jobs", o.jobs, "Runs at the same time (default: all cores)")->check(CLI::Range(1, 4096));
  command.add_option("--time-limit", o.time_limit, "Seconds of wall clock of a run (default: an hour)")
      ->check(seconds());
  command.add_option("--memory-limit", o.memory_limit_mb, "MiB of memory of a run (default: 80 % of the machine's)")
      ->check(CLI::Range(1, 1 << 30));
  command.add_option("--keep", o.keep, "Which run files stay: summary (none), failed, all")
      ->check(CLI::IsMember({"summary", "failed", "all"}));
  command.add_flag(
      "--retry-failed", o.retry_failed,
      "Does again what has no answer in the folder: runs that were killed, crashed, or had too little time or "
      "memory");
  command.add_flag("--measure", o.measure, "The true overlap of each run, too (as replay --measure)");
  add_speed_options(command, o.threads, o.simd);
  add_cache_option(command, o.no_cache);
  command.add_flag("--json", o.json, "One JSON object on stdout, all else on stderr");
  command.add_flag("--quiet", o.quiet, "No progress, no failures as they come, no summary");
}

}  // namespace

void add_batch(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("batch", "Many runs: grid, list or random design; one index, resumable");
  auto o = std::make_shared<BatchOptions>();
  command->add_option("SCENARIO", o->scenario, "Lua script that describes the scene");
  add_design_options(*command, *o);
  add_work_options(*command, *o);
  command->footer(
      "Example: verisim batch scenarios/peg_in_hole.lua --vary clearance=1mm,5mm --repeat 5 --duration 5 "
      "-o runs/pins");

  auto m = std::make_shared<MergeOptions>();
  auto* merge = add_merge(*command, *m);
  command->callback([=, &exit_code] {
    if (merge->parsed()) {
      exit_code = run_merge(*m);
      return;
    }
    find_scenario(*o);
    Batch batch(*o);
    batch.compute();
    batch.report();
    exit_code = batch.exit_code();
  });
}

}  // namespace verisim::cli
