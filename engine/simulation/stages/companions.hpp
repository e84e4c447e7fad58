// What runs beside the loop is brought to the frame's end, and what it has to say is noted.
#pragma once

#include "engine/simulation/stages/notes.hpp"
#include "engine/simulation/world.hpp"

namespace verisim {

/// In the order of adding. No allocation.
void advance_companions(World& world, Notes& notes);

}  // namespace verisim
