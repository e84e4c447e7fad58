// Scenes at the extremes of what can be asked, each judged from poses and velocities by laws that know nothing of
// contacts: conservation of momentum and energy, closed forms, distances of known shapes.
#pragma once

#include "engine/stability/row.hpp"

namespace verisim::stability {

[[nodiscard]] std::vector<Task> extreme_tasks();

}  // namespace verisim::stability
