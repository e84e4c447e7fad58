// A session: from a scenario to a simulation that is ready to step, and to the header of its run file. Used by run and
// replay.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "engine/script/scenario.hpp"

namespace verisim {

/// One scenario in one simulation. Of all that take one: @pre open_session() made it.
struct Session {
  std::unique_ptr<Inputs> inputs;
  std::unique_ptr<Scenario> scenario;
  std::unique_ptr<Simulation> simulation;
  ScenarioOptions options;
  std::uint64_t seed = 0;
  double load_s = 0;
};

/// Reads scenario and models, builds the simulation. Notices go to stderr (unless quiet) and to the events.
/// `look`, if given, sees the scene before the simulation takes it, and may change it. `inputs` are the session's if it
/// opens; else they stay, with what was read.
[[nodiscard]] Session open_session(const ScenarioOptions& options, std::unique_ptr<Inputs>&& inputs, unsigned threads,
                                   bool quiet, const std::function<void(Scene&)>& look = {});

/// Of a symbolic link what it leads to: its folder is the scenario's, with the models and scripts in it. Error(input):
/// it is no plain file.
[[nodiscard]] std::string end_of_links(const std::string& scenario);

/// The files and folders that the command line names, which a scenario may read wherever they lie.
[[nodiscard]] std::vector<std::string> named_paths(const ScenarioOptions& options);

/// The run file's data before the first frame, with all that a replay needs.
[[nodiscard]] RunHeader header_of(const Session& session, bool embed);

/// The invocation for a replay (sets, binds, seed, duration) as JSON, and back.
[[nodiscard]] std::string invocation_json(const ScenarioOptions& options);
[[nodiscard]] ScenarioOptions options_from_header(const RunHeader& header);

}  // namespace verisim
