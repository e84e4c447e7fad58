// Maps of outcomes over the parameters of the theories of ORACLES section 2, each cell computed by the engine's own
// loop, and the bounds that the engine shows, found by bisection, beside those of theory.
#pragma once

#include "engine/stability/row.hpp"

namespace verisim::stability {

[[nodiscard]] const std::vector<MapDescription>& map_descriptions();
/// All cells and bounds, in the order of the descriptions.
[[nodiscard]] std::vector<Task> map_tasks();

}  // namespace verisim::stability
