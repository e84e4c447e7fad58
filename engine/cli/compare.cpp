#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/base/json.hpp"
#include "engine/base/user_file.hpp"
#include "engine/cli/commands.hpp"
#include "engine/cli/options.hpp"
#include "engine/cli/program_runs.hpp"
#include "engine/cli/self_test.hpp"
#include "engine/compare/batches.hpp"
#include "engine/compare/benchmarks.hpp"
#include "engine/compare/history.hpp"
#include "engine/compare/report.hpp"
#include "engine/compare/runs.hpp"

namespace verisim::cli {
namespace {

struct CompareOptions {
  std::vector<std::string> files, programs, figures;
  std::string history;
  std::size_t runs = kJudgedRuns;
  std::uint64_t seed = 0;
  OutOptions out;
  bool self_test = false;
  bool json = false;
  bool quiet = false;
};

int tell(const compare::Comparison& comparison, const CompareOptions& o) {
  if (o.json)
    std::printf("%s\n", json_text(compare::json_of(comparison)).c_str());
  else if (!o.quiet)
    std::fputs(compare::table_of(comparison).c_str(), stdout);
  switch (compare::verdict_of(comparison)) {
    case compare::Verdict::same:
    case compare::Verdict::better:
      return 0;
    case compare::Verdict::worse:
    case compare::Verdict::different:
      return static_cast<int>(ErrorKind::check_failed);
  }
  return 0;
}

enum class InputKind { run, batch, benchmarks };

InputKind kind_of(const std::string& path) {
  if (other_than_plain(path) == "a folder") return InputKind::batch;
  return compare::looks_like_json(path) ? InputKind::benchmarks : InputKind::run;
}

const char* name_of(InputKind kind) {
  switch (kind) {
    case InputKind::run:
      return "a run file";
    case InputKind::batch:
      return "a batch folder";
    case InputKind::benchmarks:
      return "JSON of benchmarks";
  }
  return "";
}

compare::Comparison compared(const std::string& a, const std::string& b) {
  const InputKind kind = kind_of(a), other = kind_of(b);
  if (kind != other)
    fail(ErrorKind::input, "{} looks like {}, {} like {}; compare two of a kind", a, name_of(kind), b, name_of(other));
  const compare::Bounds& bounds = compare::built_in_bounds();
  switch (kind) {
    case InputKind::run:
      return compare::compare_runs(a, b, bounds);
    case InputKind::batch:
      return compare::compare_batches(a, b, bounds);
    case InputKind::benchmarks:
      return compare::compare_benchmarks(a, b, bounds);
  }
  return {};
}

int tell_self_test(const CompareOptions& o) {
  if (o.files.size() > 1) fail(ErrorKind::usage, "--self-test takes one file of times at most");
  const SelfTest test = self_test(o.files.empty() ? "" : o.files[0], o.quiet);
  if (o.json)
    std::printf("%s\n", json_text(json_of(test)).c_str());
  else if (!o.quiet)
    std::fputs(table_of(test).c_str(), stdout);
  return test.kept ? 0 : static_cast<int>(ErrorKind::check_failed);
}

int tell_history(const CompareOptions& o) {
  if (!o.files.empty()) fail(ErrorKind::usage, "--history takes one folder and no other files");
  const compare::History history = compare::read_history(o.history, o.figures);
  if (o.json)
    std::printf("%s\n", json_text(compare::json_of(history)).c_str());
  else if (!o.quiet)
    std::fputs(compare::table_of(history).c_str(), stdout);
  return 0;
}

int run_compare(const CompareOptions& o) {
  if (!o.history.empty()) return tell_history(o);
  if (o.self_test) return tell_self_test(o);
  if (!o.programs.empty())
    return tell(compare_programs({.a = o.programs[0],
                                  .b = o.programs[1],
                                  .arguments = o.files,
                                  .runs = o.runs,
                                  .seed = o.seed,
                                  .times_file = o.out.path,
                                  .force = o.out.force,
                                  .quiet = o.quiet}),
                o);
  if (o.files.size() != 2)
    fail(ErrorKind::usage, "compare takes two: run files, batch folders or benchmark JSON; see verisim compare --help");
  return tell(compared(o.files[0], o.files[1]), o);
}

}  // namespace

void add_compare(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand(
      "compare", "What got slower, costlier or less accurate between two runs, batches, benchmark files or builds");
  auto options = std::make_shared<CompareOptions>();
  command->add_option("FILES", options->files,
                      "A and B: two run files, two batch folders, or two files of Google Benchmark's JSON "
                      "(repetitions, not aggregated). With --programs: what both are called with, after --");
  auto* programs =
      command
          ->add_option("--programs", options->programs,
                       "Two builds of verisim, called in turns with the same arguments")
          ->type_name("A B")
          ->type_size(2)
          ->expected(1)
          ->allow_extra_args(false);  // two words at once: else it swallows the --, and ARGS are options of compare
  command->add_option("--runs", options->runs, "Runs of each of them; the first, more, is left out")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str()
      ->needs(programs);
  add_seed_option(
      *command, [=](std::uint64_t seed) { options->seed = seed; },
      "Draws which of them runs first in each pair (default 0)");
  add_out_options(*command, options->out, "CSV of every time that --programs takes")->needs(programs);
  auto* history = command
                      ->add_option("--history", options->history,
                                   "A figure over versions: folder of run files or benchmark JSON, one a version, "
                                   "in the order of their names")
                      ->type_name("FOLDER")
                      ->excludes(programs);
  command->add_option("--figure", options->figures, "Which figure (repeatable): /cost/contacts, max_force_N, a measure")
      ->type_name("NAME")
      ->needs(history);
  command
      ->add_flag("--self-test", options->self_test,
                 "How often compare errs: by resampling the times of FILES, or those that it has (a minute)")
      ->excludes(programs)
      ->excludes(history);
  command->add_flag("--json", options->json, "One JSON object on stdout");
  command->add_flag("--quiet", options->quiet, "Say nothing: the exit code is the verdict");
  command->footer(
      "The verdict is same, better, worse or different; exit code 1 for the last two.\n"
      "Example: verisim run scenarios/slide.lua -o runs/a.h5 && verisim run scenarios/slide.lua -o runs/b.h5 && "
      "verisim compare runs/a.h5 runs/b.h5\n"
      "         verisim compare --programs build/verisim build/verisim --runs 10 -- run scenarios/slide.lua\n"
      "         verisim compare --self-test");
  command->callback([=, &exit_code] { exit_code = run_compare(*options); });
}

}  // namespace verisim::cli
