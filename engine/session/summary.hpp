// What a run reports when it is over (base/run_figures.hpp): one JSON object, a table for people, the attributes of
// /summary.
#pragma once

#include <map>
#include <string>

#include "engine/base/run_figures.hpp"
#include "engine/session/run_loop.hpp"
#include "engine/session/session.hpp"

namespace verisim {

[[nodiscard]] const char* name_of(LoopEnd end);
[[nodiscard]] RunFigures figures_of(const Session& session, LoopResult& loop, const std::string& run_file);
/// That a run for which `exact` was asked was answered by voxels in more than 1 % of its frames with contact, and why;
/// empty: it was not.
[[nodiscard]] std::string fallback_warning(const RunFigures& run);
[[nodiscard]] std::string to_json(const RunFigures& run);
[[nodiscard]] std::string to_table(const RunFigures& run);
[[nodiscard]] std::map<std::string, Attribute> to_attributes(const RunFigures& run);

}  // namespace verisim
