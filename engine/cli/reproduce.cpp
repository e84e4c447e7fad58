#include <cstdio>
#include <filesystem>
#include <memory>

#include "engine/base/error.hpp"
#include "engine/base/json.hpp"
#include "engine/cli/commands.hpp"
#include "engine/cli/scenarios_folder.hpp"
#include "engine/record/file_replace.hpp"
#include "engine/reproduce/reproductions.hpp"
#include "engine/session/prepared_parts.hpp"
#include "engine/session/progress_line.hpp"
#include "engine/session/recorded_run.hpp"
#include "engine/session/stop_watch.hpp"

namespace verisim::cli {
namespace {

namespace fs = std::filesystem;

using reproduce::Reproduction;

constexpr const char* kDefaultFolder = "runs/reproduce";

struct ReproduceOptions {
  std::string out;  ///< empty: kDefaultFolder, or one beside it
  std::string scenarios;
  std::vector<std::string> only;
  bool quick = false;
  bool json = false;
  bool quiet = false;
  bool force = false;
};

/// A run as `verisim run` makes it. Error(diverged, io, interrupted) if it did not come to its end.
reproduce::TimedRun run_scenario(const std::string& folder, const reproduce::RunRequest& request, bool force) {
  ScenarioOptions options;
  options.path = (fs::path(folder) / (request.scenario + ".lua")).string();
  options.sets = request.sets;
  options.duration = request.duration;
  options.seed = request.seed;
  auto inputs = std::make_unique<Inputs>(Inputs::live(folder, {}, prepared_parts()));
  Session session = open_session(options, std::move(inputs), 1, true);
  RecordedRun run = record_run(
      session, {.file = request.file, .force = force, .paced = request.paced, .empty_block = request.empty_block});
  if (run.loop.end == LoopEnd::interrupted) fail(ErrorKind::interrupted, "{}: interrupted", request.file);
  if (run.loop.end != LoopEnd::done)
    fail(static_cast<ErrorKind>(exit_code_of(run.loop.end)), "{}: {}", request.file,
         run.loop.error.empty() ? run.figures.end : run.loop.error);
  return {run.figures, std::move(run.loop.frame_ns), std::move(run.loop.collision_frame_ns),
          std::move(run.loop.block_overruns), std::move(run.loop.empty_block_overruns)};
}

Json json_of_figure(const reproduce::Figure& figure) {
  if (const auto* words = std::get_if<std::string>(&figure)) return *words;
  return std::get<double>(figure);
}

Json json_of_row(const reproduce::Row& row) {
  const std::optional<double> q = ratio(row);
  Json j = {{"id", row.id},
            {"what", row.what},
            {"unit", row.unit},
            {"published", json_of_figure(row.published)},
            {"here", json_of_figure(row.here)},
            {"ratio", q ? Json(*q) : Json()},
            {"why", row.why},
            {"runs", row.runs}};
  if (row.interval) j["interval_95"] = {row.interval->first, row.interval->second};
  return j;
}

/// Every row, and every file that one of them comes from, once.
std::string json_of_rows(const std::vector<reproduce::Row>& rows) {
  Json j = {{"rows", Json::array()}, {"runs", Json::array()}};
  for (const reproduce::Row& row : rows) {
    j["rows"].push_back(json_of_row(row));
    for (const std::string& file : row.runs)
      if (std::find(j["runs"].begin(), j["runs"].end(), file) == j["runs"].end()) j["runs"].push_back(file);
  }
  return json_text(j);
}

/// A default folder that no other process has: the first of runs/reproduce, runs/reproduce-2 … It has a mark in it.
class OwnFolder {
 public:
  OwnFolder() {
    for (int n = 1; mark_ == nullptr; ++n) {
      path_ = n == 1 ? kDefaultFolder : fmt::format("{}-{}", kDefaultFolder, n);
      make_folder_of(mark_path());
      auto mark = std::make_unique<MarkedFile>(mark_path(), MarkedFile::Mark::writer);
      if (mark->descriptor() < 0) refuse_write(mark_path(), system_cause());
      if (mark->refused()) continue;
      if (mark->is_at(mark_path()))
        mark_ = std::move(mark);
      else
        --n;  // its former owner has just taken it away
    }
  }
  ~OwnFolder() {
    std::error_code ignored;
    fs::remove(mark_path(), ignored);
  }
  OwnFolder(const OwnFolder&) = delete;
  OwnFolder& operator=(const OwnFolder&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  [[nodiscard]] std::string mark_path() const { return path_ + "/.in_use"; }
  std::string path_;
  std::unique_ptr<MarkedFile> mark_;
};

bool is_wanted(const ReproduceOptions& o, const Reproduction& r) {
  return o.only.empty() || std::find(o.only.begin(), o.only.end(), r.id) != o.only.end();
}

void run_reproduce(const ReproduceOptions& o) {
  const std::unique_ptr<OwnFolder> own = o.out.empty() ? std::make_unique<OwnFolder>() : nullptr;
  reproduce::Workshop workshop{o.quick, own ? own->path() : o.out, {}};
  const std::string scenarios = o.scenarios.empty() ? scenarios_folder() : o.scenarios;
  workshop.run = [&](const reproduce::RunRequest& request) { return run_scenario(scenarios, request, o.force); };
  workshop.force = o.force;
  make_folder_of(workshop.file("any"));
  std::vector<reproduce::Row> rows;
  for (const Reproduction& r : reproduce::reproductions()) {
    if (!is_wanted(o, r)) continue;
    const std::string name = fmt::format("{:<4} {:<40}", r.id, r.what);
    const StopWatch watch;
    {
      const ProgressLine line(!o.quiet);
      line.say(name);
      for (reproduce::Row& row : r.measure(workshop)) rows.push_back(std::move(row));
    }
    if (!o.quiet) std::fprintf(stderr, "%s %6.1f s\n", name.c_str(), watch.seconds());
  }
  std::printf("%s%s", o.json ? json_of_rows(rows).c_str() : table_of(rows).c_str(), o.json ? "\n" : "");
}

std::vector<std::string> ids() {
  std::vector<std::string> all;
  for (const Reproduction& r : reproduce::reproductions()) all.emplace_back(r.id);
  return all;
}

}  // namespace

void add_reproduce(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("reproduce", "The dissertation's figures, measured again side by side");
  auto o = std::make_shared<ReproduceOptions>();
  command->add_option(
      "-o,--out", o->out,
      "Folder for run files and tables (default: runs/reproduce, or runs/reproduce-2 while another writes there)");
  command->add_flag("--force", o->force, "Replace plain files of any kind in that folder; devices and folders never");
  command->add_option("--only", o->only, "Only these (repeatable)")->take_all()->check(CLI::IsMember(ids()));
  command->add_option("--scenarios", o->scenarios, "Folder of the shipped scenarios (else found beside the program)");
  command->add_flag("--quick", o->quick, "Shorter runs: under 45 s in all");
  command->add_flag("--json", o->json, "One JSON object on stdout");
  command->add_flag("--quiet", o->quiet, "No progress");
  command->footer("Example: verisim reproduce --quick --only R7");
  command->callback([=, &exit_code] {
    run_reproduce(*o);
    exit_code = 0;
  });
}

}  // namespace verisim::cli
