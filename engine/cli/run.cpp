#include <cstdio>
#include <filesystem>
#include <memory>

#include "engine/base/error.hpp"
#include "engine/base/user_file.hpp"
#include "engine/cli/commands.hpp"
#include "engine/cli/options.hpp"
#include "engine/cli/recorded_run.hpp"
#include "engine/cli/streams.hpp"
#include "engine/contact/query.hpp"

namespace verisim::cli {
namespace {

namespace fs = std::filesystem;

std::string default_run_file(const std::string& scenario) {
  return (fs::path("runs") / fs::path(scenario).stem()).string() + ".h5";
}

/// Of a symbolic link what it leads to: its folder is the scenario's, with the models and scripts in it.
std::string end_of_links(const std::string& scenario) {
  const std::string type = other_than_plain(scenario);
  if (!type.empty()) fail(ErrorKind::input, "{}: is {}, a file is wanted; name a scenario", scenario, type);
  std::error_code error;
  if (!fs::is_symlink(scenario, error)) return scenario;
  const fs::path end = fs::canonical(scenario, error);
  if (error) fail(ErrorKind::input, "{}: a symbolic link that leads nowhere ({})", scenario, error.message());
  return end.string();
}

int run(const std::string& named, const SimulateOptions& o) {
  const std::string scenario = end_of_links(named);
  use_simd_target(o.simd);
  ScenarioOptions options;
  options.path = scenario;
  options.sets = split_pairs("--set", o.sets);
  options.binds = split_pairs("--bind", o.binds);
  options.seed = o.seed;
  options.duration = o.duration;
  auto inputs = std::make_unique<Inputs>(Inputs::live(fs::path(scenario).parent_path().string(), named_paths(options)));
  Session session = open_session(options, std::move(inputs), o.threads, o.quiet);
  const bool is_default = o.out.path.empty();
  const RecordedRun run = record_run(session, {.file = is_default ? default_run_file(scenario) : o.out.path,
                                               .another_name = is_default,
                                               .force = o.out.force,
                                               .paced = o.realtime,
                                               .embed = !o.no_embed,
                                               .progress = !o.quiet});
  if (!run.loop.error.empty()) print_error(run.loop.error.c_str());
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
