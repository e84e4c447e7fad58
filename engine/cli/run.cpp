#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <memory>

#include "engine/base/error.hpp"
#include "engine/cli/commands.hpp"
#include "engine/cli/options.hpp"
#include "engine/cli/run_loop.hpp"
#include "engine/cli/session.hpp"
#include "engine/cli/summary.hpp"
#include "engine/contact/query.hpp"

namespace verisim::cli {
namespace {

namespace fs = std::filesystem;

std::string default_run_file(const std::string& scenario) {
  return (fs::path("runs") / fs::path(scenario).stem()).string() + ".h5";
}

/// The folder of a file that is to be written, made if it is not there.
void make_folder_of(const std::string& file) {
  const fs::path folder = fs::path(file).parent_path();
  std::error_code error;
  if (!folder.empty()) fs::create_directories(folder, error);
  if (error) fail(ErrorKind::io, "{}: the folder cannot be made ({}); choose another with -o", file, error.message());
}

std::function<void(std::uint64_t)> progress_bar(std::uint64_t frames, bool quiet) {
  if (quiet || isatty(STDERR_FILENO) == 0) return {};
  return [frames](std::uint64_t done) {
    constexpr int kWidth = 40;
    const int filled = static_cast<int>(kWidth * done / frames);
    std::fprintf(stderr, "\r  [%-*s] %3d %%", kWidth, std::string(static_cast<std::size_t>(filled), '=').c_str(),
                 static_cast<int>(100 * done / frames));
    std::fflush(stderr);
  };
}

int exit_code_of(LoopEnd end) {
  switch (end) {
    case LoopEnd::done:
      return 0;
    case LoopEnd::interrupted:
      return static_cast<int>(ErrorKind::interrupted);
    case LoopEnd::diverged:
      return static_cast<int>(ErrorKind::diverged);
    case LoopEnd::io_failed:
      return static_cast<int>(ErrorKind::io);
  }
  return 0;
}

int run(const std::string& scenario, const SimulateOptions& o) {
  use_simd_target(o.simd);
  ScenarioOptions options;
  options.path = scenario;
  options.sets = split_pairs("--set", o.sets);
  options.binds = split_pairs("--bind", o.binds);
  options.seed = o.seed;
  options.duration = o.duration;
  auto inputs = std::make_unique<Inputs>(Inputs::live(fs::path(scenario).parent_path().string(), named_paths(options)));
  Session session = open_session(options, std::move(inputs), o.threads, o.quiet);
  Simulation& simulation = *session.simulation;

  const std::string file = o.out.empty() ? default_run_file(scenario) : o.out;
  make_folder_of(file);
  Schema schema;
  simulation.describe(schema);
  add_timing_columns(schema);
  RecorderOptions recording;
  recording.paced = o.realtime;
  recording.frames_unflushed = static_cast<std::size_t>(std::max(1.0, 0.1 / simulation.dt()));
  Recorder recorder(file, schema, header_of(session, !o.no_embed), recording);

  catch_interrupts();
  LoopOptions loop;
  loop.frames = simulation.frames_planned();
  loop.paced = o.realtime;
  loop.finished = [&] { return session.scenario->finished(); };
  loop.progress = progress_bar(loop.frames, o.quiet);
  LoopResult result = run_loop(simulation, &recorder, schema, loop);
  if (loop.progress) std::fprintf(stderr, "\r%60s\r", "");
  const Summary summary = summarize(session, result, file);
  if (result.end != LoopEnd::io_failed) recorder.close(to_attributes(summary), {{"state_hash", summary.state_hash}});
  if (!result.error.empty()) std::fprintf(stderr, "error: %s\n", result.error.c_str());
  if (o.json)
    std::printf("%s\n", to_json(summary).c_str());
  else if (!o.quiet)
    std::printf("%s", to_table(summary).c_str());
  return exit_code_of(result.end);
}

}  // namespace

void add_run(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("run", "One run: one HDF5 run file and a summary");
  auto scenario = std::make_shared<std::string>();
  auto options = std::make_shared<SimulateOptions>();
  command->add_option("SCENARIO", *scenario, "Lua script that describes the scene")->required();
  add_simulate_options(*command, *options);
  command->footer("Example: verisim run scenarios/peg_in_hole.lua --set clearance=mm(2) --json");
  command->callback([=, &exit_code] { exit_code = run(*scenario, *options); });
}

}  // namespace verisim::cli
