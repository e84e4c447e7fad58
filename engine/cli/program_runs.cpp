#include "engine/cli/program_runs.hpp"
#include "engine/base/json.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <filesystem>

#include "engine/base/error.hpp"
#include "engine/base/text.hpp"
#include "engine/base/user_file.hpp"
#include "engine/compare/bounds.hpp"
#include "engine/compare/runs.hpp"
#include "engine/compare/series.hpp"
#include "engine/record/file_replace.hpp"
#include "engine/record/output_place.hpp"
#include "engine/session/interrupts.hpp"
#include "engine/session/progress_line.hpp"
#include "engine/session/stop_watch.hpp"

namespace verisim::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTimesBeginning = "pair,program";

/// For the outputs of both programs; removed with all that is in it.
class WorkFolder {
 public:
  WorkFolder() {
    std::error_code none;
    std::string pattern = (fs::temp_directory_path(none) / "verisim_compare_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) refuse_write(pattern, system_cause());
    path_ = pattern;
  }
  ~WorkFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  fs::path path_;
};

struct ProgramRun {
  double process_s = 0;  ///< wall clock from start to end
  double cpu_s = 0;      ///< of the process and all that it waited for
  std::string said;      ///< on stdout
};

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

std::string last_line_of(const std::string& file) {
  std::string text = UserFile(file, file).content();
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return shown(text.substr(text.rfind('\n') + 1), 300);  // npos + 1 is 0
}

/// Starts a program, waits for its end and times it. A signal that asks this command to end reaches both.
ProgramRun run_program(const std::string& program, const std::vector<std::string>& arguments, const WorkFolder& work) {
  const std::string out = work.file("out"), err = work.file("err");
  std::vector<std::string> words = {program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  constexpr int kNew = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), kNew, 0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), kNew, 0600);
  const StopWatch watch;
  pid_t child = -1;
  const int failure = posix_spawn(&child, program.c_str(), &actions, nullptr, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0)
    fail(ErrorKind::input, "{}: cannot be started ({}); name a built verisim", program,
         std::generic_category().message(failure));
  int status = 0;
  rusage used{};
  while (wait4(child, &status, 0, &used) < 0 && errno == EINTR) {
  }
  ProgramRun run{watch.seconds(), seconds_of(used.ru_utime) + seconds_of(used.ru_stime), ""};
  if (was_interrupted()) fail(ErrorKind::interrupted, "{}: interrupted", program);
  if (!WIFEXITED(status))
    fail(ErrorKind::input, "{}: was ended by signal {}; run it by itself to see why", program, WTERMSIG(status));
  if (WEXITSTATUS(status) != 0)
    fail(ErrorKind::input, "{}: ended with {}: {}; run it by itself with these arguments", program, WEXITSTATUS(status),
         last_line_of(err));
  run.said = UserFile(out, out).content();
  return run;
}

/// What is timed: the program as a whole, and of `run` what its --json tells.
class Times {
 public:
  explicit Times(const ProgramRun& example) {
    figures_ = {{"process_s", "s"}, {"cpu_s", "s"}};
    const Json said = parse_json_or_discard(example.said);
    for (const char* name : {"load_s", "wall_s"})
      if (said.is_object() && said.contains(name) && said[name].is_number()) figures_.push_back({name, "s"});
    for (const char* name : {"frame_ns", "collision_frame_ns"})
      if (said.is_object() && said.contains(name) && said[name].value("p50", 0.0) > 0)
        figures_.push_back({std::string(name) + ".p50", "ns"});
  }
  [[nodiscard]] const std::vector<compare::SeriesFigure>& figures() const { return figures_; }

  /// Error(input) if a time is missing or not above 0.
  [[nodiscard]] compare::RunTimes of(const std::string& program, const ProgramRun& run) const {
    compare::RunTimes times = {run.process_s, run.cpu_s};
    const Json said = parse_json_or_discard(run.said);
    for (std::size_t i = times.size(); i < figures_.size(); ++i) {
      const std::string& name = figures_[i].name;
      const bool is_quantile = name.ends_with(".p50");
      const std::string key = is_quantile ? name.substr(0, name.size() - 4) : name;
      const Json value = !said.is_object()                   ? Json()
                         : is_quantile && said.contains(key) ? said[key].value("p50", Json())
                                                             : said.value(key, Json());
      times.push_back(value.is_number() ? value.get<double>() : 0.0);
    }
    for (std::size_t i = 0; i < times.size(); ++i)
      if (!(times[i] > 0)) fail(ErrorKind::input, "{}: tells no {} above 0", program, figures_[i].name);
    return times;
  }

 private:
  std::vector<compare::SeriesFigure> figures_;
};

/// Of those that are there.
std::vector<FileIdentity> identities_of(const std::vector<std::string>& paths) {
  std::vector<FileIdentity> identities;
  for (const std::string& path : paths)
    if (const auto identity = identity_of(path)) identities.push_back(*identity);
  return identities;
}

bool is_run(const std::vector<std::string>& arguments) {
  return !arguments.empty() && arguments[0] == "run";
}

/// Of `run`: a run file of its own, and its summary as JSON.
std::vector<std::string> arguments_of(const ProgramsAsked& asked, const std::string& run_file) {
  std::vector<std::string> arguments = asked.arguments;
  if (!arguments.empty() && arguments[0] == "batch")
    fail(ErrorKind::usage,
         "a batch that is done is not done again, so the second call measures nothing; compare two batch folders, or "
         "one run of it: -- run SCENARIO");
  if (!is_run(arguments)) return arguments;
  const auto has = [&](const std::string& option) {
    return std::any_of(arguments.begin(), arguments.end(),
                       [&](const std::string& word) { return word == option || word.starts_with(option + "="); });
  };
  if (has("-o") || has("--out"))
    fail(ErrorKind::usage, "ARGS have -o: each program writes a run file of its own; leave it out");
  arguments.insert(arguments.end(), {"-o", run_file});
  if (!has("--json")) arguments.emplace_back("--json");
  return arguments;
}

std::string csv_of(const Times& times, const std::vector<std::pair<char, compare::RunTimes>>& runs) {
  std::string text = kTimesBeginning;
  for (const auto& figure : times.figures()) text += "," + figure.name;
  text += "\n";
  for (std::size_t i = 0; i < runs.size(); ++i) {
    text += fmt::format("{},{}", i / 2, runs[i].first);
    for (const double time : runs[i].second) text += fmt::format(",{:.9g}", time);
    text += "\n";
  }
  return text;
}

}  // namespace

compare::Comparison compare_programs(const ProgramsAsked& asked) {
  const InterruptScope scope;
  const std::vector<FileIdentity> programs = identities_of({asked.a, asked.b});
  if (!asked.times_file.empty())
    (void)check_output(
        {.path = asked.times_file, .kind = OutputKind::text, .force = asked.force, .beginning = kTimesBeginning},
        programs);
  const WorkFolder work;
  const std::string file_a = work.file("a.h5"), file_b = work.file("b.h5");
  const std::vector<std::string> for_a = arguments_of(asked, file_a), for_b = arguments_of(asked, file_b);
  // The first run of each finds cold caches. It is for counts and outcomes alone.
  const ProgramRun first_a = run_program(asked.a, for_a, work);
  (void)run_program(asked.b, for_b, work);
  compare::Comparison c{.kind = "programs", .a = {asked.a, "", ""}, .b = {asked.b, "", ""}};
  if (is_run(asked.arguments)) {
    for (const auto& [program, file] : {std::pair(asked.a, file_a), std::pair(asked.b, file_b)})
      if (!identity_of(file))
        fail(ErrorKind::input, "{}: ended with 0 and wrote no run file; name a built verisim", program);
    c = compare::compare_runs(file_a, file_b, compare::built_in_bounds());
    c.kind = "programs";
    c.a.path = asked.a;
    c.b.path = asked.b;
  } else {
    c.notices.push_back("ARGS are no `run`: times alone are compared");
  }
  const Times times(first_a);
  compare::Series series(times.figures());
  std::vector<std::pair<char, compare::RunTimes>> taken;
  const ProgressLine line(!asked.quiet);
  const StopWatch watch;
  for (std::size_t pair = 0; pair < asked.runs; ++pair) {
    const double left =
        pair == 0 ? 0 : watch.seconds() / static_cast<double>(pair) * static_cast<double>(asked.runs - pair);
    line.say(
        fmt::format("pair {} of {}{}", pair + 1, asked.runs, pair == 0 ? "" : fmt::format(", {:.0f} s left", left)));
    compare::RunTimes of_a, of_b;
    for (const bool is_b : {compare::is_b_first(asked.seed, pair), !compare::is_b_first(asked.seed, pair)}) {
      const std::string& program = is_b ? asked.b : asked.a;
      compare::RunTimes& of = is_b ? of_b : of_a;
      of = times.of(program, run_program(program, is_b ? for_b : for_a, work));
      taken.emplace_back(is_b ? 'B' : 'A', of);
    }
    series.add_pair(of_a, of_b);
  }
  if (!asked.times_file.empty()) write_text(asked.times_file, csv_of(times, taken), asked.force, programs);
  c.times = compare::judge_times(
      series.samples(), {.effect = compare::built_in_bounds().effect_interleaved, .alpha = compare::kAlphaInTurns});
  return c;
}

}  // namespace verisim::cli
