#include "engine/session/session.hpp"

#include <cstdio>
#include <filesystem>
#include <limits>
#include <sstream>

#include "engine/base/error.hpp"
#include "engine/base/hash.hpp"
#include "engine/base/json.hpp"
#include "engine/base/text.hpp"
#include "engine/base/user_file.hpp"
#include "engine/session/memory_use.hpp"
#include "engine/session/origin.hpp"
#include "engine/session/stop_watch.hpp"
#include "engine/session/warnings.hpp"

namespace verisim {

namespace {

Attribute whole_number(std::uint64_t n) {
  if (n <= static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) return static_cast<std::int64_t>(n);
  return n;
}

/// Error if the duration is shorter than a frame or has more frames than can be numbered; of the command line's, wrong
/// usage.
void check_duration(const SimulationParameters& parameters, bool from_command_line) {
  constexpr double kFramesMax = 1e9;  // as Simulation::frames_planned has it
  if (!parameters.duration) return;
  const double frames = *parameters.duration / parameters.timestep;
  const ErrorKind kind = from_command_line ? ErrorKind::usage : ErrorKind::input;
  const char* name = from_command_line ? "--duration" : "duration";
  if (!(frames >= 0.5))
    fail(kind, "{} {} s is shorter than one frame of {} s; make it at least that", name, *parameters.duration,
         parameters.timestep);
  if (!(frames <= kFramesMax))
    fail(kind, "{} {} s is {:.4g} frames of {} s, more than the {:.0f} that a run may have; shorten it", name,
         *parameters.duration, frames, parameters.timestep, kFramesMax);
}

}  // namespace

Session open_session(const ScenarioOptions& options, std::unique_ptr<Inputs>&& inputs, unsigned threads, bool quiet,
                     const std::function<void(Scene&)>& look) {
  const StopWatch watch;
  const MemoryUse use("building the scene of " + options.path);
  Session session;
  session.options = options;
  session.scenario = std::make_unique<Scenario>(options, *inputs);
  Scene scene = session.scenario->take_scene();
  if (look) look(scene);
  session.seed = scene.parameters.seed;
  check_duration(scene.parameters, options.duration.has_value());
  std::vector<std::string> notices = session.scenario->notices();
  for (const BodyDescription& body : scene.bodies)
    for (const Part& part : body.parts)
      for (const std::string& warning : warnings_about(part)) notices.push_back("'" + body.name + "': " + warning);
  for (const auto& device : scene.devices)
    for (const std::string& idle : device->idle())
      notices.push_back("device '" + idle + "' is driven by nothing and stays at its home pose; --bind drives it");
  session.simulation = std::make_unique<Simulation>(std::move(scene), SimulationOptions{threads, inputs->store()});
  const auto warn = [&](const std::string& text) {
    if (!quiet) std::fprintf(stderr, "warning: %s\n", shown(text).c_str());
  };
  std::vector<std::string> warnings;
  for (const Event& event : session.simulation->events())
    if (is_warning(event)) warnings.push_back(event.text);
  if (!quiet) print_warnings(warnings);
  for (const std::string& notice : notices) {
    warn(notice);
    session.simulation->add_event("warning", notice);
  }
  session.scenario->attach(*session.simulation);
  session.inputs = std::move(inputs);
  session.load_s = watch.seconds();
  return session;
}

std::string end_of_links(const std::string& scenario) {
  const std::string type = other_than_plain(scenario);
  if (!type.empty()) fail(ErrorKind::input, "{}: is {}, a file is wanted; name a scenario", scenario, type);
  std::error_code error;
  if (!std::filesystem::is_symlink(scenario, error)) return scenario;
  const std::filesystem::path end = std::filesystem::canonical(scenario, error);
  if (error) fail(ErrorKind::input, "{}: a symbolic link that leads nowhere ({})", scenario, error.message());
  return end.string();
}

std::vector<std::string> named_paths(const ScenarioOptions& options) {
  std::vector<std::string> paths;
  const auto add_if_there = [&](const std::string& value) {
    std::error_code error;
    if (std::filesystem::exists(value, error)) paths.push_back(value);
  };
  for (const auto& [key, value] : options.sets) {
    std::istringstream list(value);  // one file, or several with commas between them
    for (std::string file; std::getline(list, file, ',');) add_if_there(file);
  }
  for (const auto& [name, source] : options.binds) add_if_there(source);
  return paths;
}

std::string invocation_json(const ScenarioOptions& options) {
  Json j;
  j["path"] = options.path;
  j["set"] = options.sets;
  j["bind"] = options.binds;
  if (options.seed) j["seed"] = *options.seed;
  if (options.duration) j["duration"] = *options.duration;
  return json_text(j);
}

ScenarioOptions options_from_header(const RunHeader& header) {
  const auto found = header.attributes.find("invocation");
  if (found == header.attributes.end() || !std::holds_alternative<std::string>(found->second))
    fail(ErrorKind::input, "the run file does not say how it was made (attribute 'invocation'); it cannot be replayed");
  try {
    const Json j = parse_json(std::get<std::string>(found->second));
    ScenarioOptions options;
    options.path = j.at("path");
    options.sets = j.at("set");
    options.binds = j.at("bind");
    if (j.contains("seed")) options.seed = j["seed"].get<std::uint64_t>();
    if (j.contains("duration")) options.duration = j["duration"].get<double>();
    return options;
  } catch (const Json::exception&) {
    fail(ErrorKind::input, "the run file's attribute 'invocation' is damaged; it cannot be replayed");
  }
}

RunHeader header_of(const Session& session, bool embed) {
  VERISIM_ASSERT(session.inputs != nullptr && session.scenario != nullptr && session.simulation != nullptr);
  RunHeader header;
  const std::string& path = session.options.path;
  header.attributes["version"] = VERISIM_VERSION;
  header.attributes["commit"] = commit();
  header.attributes["compiler"] = compiler();
  header.attributes["cpu"] = cpu_model();
  header.attributes["scenario"] = std::filesystem::path(path).filename().string();
  header.attributes["parameters"] = session.scenario->parameters_json();
  header.attributes["seed"] = whole_number(session.seed);
  header.attributes["dt"] = session.simulation->dt();
  header.attributes["invocation"] = invocation_json(session.options);
  header.files = session.inputs->files();
  header.models = session.inputs->models();
  if (!header.files.empty()) header.attributes["scenario_sha256"] = header.files.front().sha256;
  if (!embed)
    for (InputFile& file : header.files) {
      file.embedded = false;
      file.content.clear();
    }
  return header;
}

}  // namespace verisim
