// verisim inspect SCENARIO.lua: what a run of it will need, and why, before anything is simulated.
#pragma once

#include "engine/script/scenario.hpp"

namespace verisim::cli {

void inspect_scenario(const ScenarioOptions& options, bool json);

}  // namespace verisim::cli
