#include <cstdio>
#include <filesystem>
#include <memory>

#include "engine/base/json.hpp"
#include "engine/cli/commands.hpp"
#include "engine/cli/options.hpp"
#include "engine/cli/streams.hpp"
#include "engine/contact/query.hpp"
#include "engine/script/parameters.hpp"
#include "engine/session/prepared_parts.hpp"
#include "engine/session/recorded_run.hpp"

namespace verisim::cli {
namespace {

namespace fs = std::filesystem;

std::string default_run_file(const std::string& scenario) {
  return (fs::path("runs") / fs::path(scenario).stem()).string() + ".h5";
}

/// What can be set: for people, or as JSON.
std::string text_of(const std::vector<ParameterDeclaration>& parameters, bool as_json) {
  Json list = Json::array();
  std::string table = fmt::format("{:<20} {:<20} {:<6} {}\n", "parameter", "default", "unit", "meaning");
  for (const ParameterDeclaration& p : parameters) {
    list.push_back({{"name", p.name}, {"default", parse_json(p.value_json)}, {"unit", p.unit}, {"meaning", p.meaning}});
    std::string row = fmt::format("{:<20} {:<20} {:<6} {}", p.name, p.value_json, p.unit, p.meaning);
    row.erase(row.find_last_not_of(' ') + 1);
    table += row + "\n";
  }
  if (as_json) return json_text(Json{{"parameters", list}}) + "\n";
  return parameters.empty() ? "this scenario has no parameters\n" : table;
}

int run(const std::string& named, const SimulateOptions& o, bool parameters) {
  const std::string scenario = end_of_links(named);
  use_simd_target(o.simd);
  ScenarioOptions options;
  options.path = scenario;
  options.sets = split_pairs("--set", o.sets);
  options.binds = split_pairs("--bind", o.binds);
  options.seed = o.seed;
  options.duration = o.duration;
  const std::shared_ptr<PreparedStore> store = prepared_parts(!o.no_cache);
  auto inputs =
      std::make_unique<Inputs>(Inputs::live(fs::path(scenario).parent_path().string(), named_paths(options), store));
  if (parameters) {
    std::fputs(text_of(DeclaredParameters(options, *inputs).all(), o.json).c_str(), stdout);
    return 0;
  }
  Session session = open_session(options, std::move(inputs), o.threads, o.quiet);
  const bool is_default = o.out.path.empty();
  const RecordedRun run = record_run(session, {.file = is_default ? default_run_file(scenario) : o.out.path,
                                               .another_name = is_default,
                                               .force = o.out.force,
                                               .paced = o.realtime,
                                               .embed = !o.no_embed,
                                               .progress = !o.quiet});
  if (!o.quiet) warn_of_damage(store.get());
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
  auto parameters = std::make_shared<bool>(false);
  command->add_flag("--parameters", *parameters, "List what --set can change, and run nothing");
  command->footer("Example: verisim run scenarios/peg_in_hole.lua --set clearance=2mm --json");
  command->callback([=, &exit_code] { exit_code = run(*scenario, *options, *parameters); });
}

}  // namespace verisim::cli
