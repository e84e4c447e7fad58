#include <cstdio>
#include <filesystem>
#include <memory>

#include "engine/cli/commands.hpp"
#include "engine/cli/options.hpp"
#include "engine/cli/recorded_run.hpp"
#include "engine/contact/query.hpp"

namespace verisim::cli {
namespace {

namespace fs = std::filesystem;

std::string default_run_file(const std::string& scenario) {
  return (fs::path("runs") / fs::path(scenario).stem()).string() + ".h5";
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
  const std::string file = o.out.empty() ? default_run_file(scenario) : o.out;
  const RecordedRun run =
      record_run(session, {.file = file, .paced = o.realtime, .embed = !o.no_embed, .progress = !o.quiet});
  if (!run.loop.error.empty()) std::fprintf(stderr, "error: %s\n", run.loop.error.c_str());
  if (o.json)
    std::printf("%s\n", to_json(run.figures).c_str());
  else if (!o.quiet)
    std::printf("%s", to_table(run.figures).c_str());
  return exit_code_of(run.loop.end);
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
