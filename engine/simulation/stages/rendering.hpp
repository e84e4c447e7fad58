// What the hands feel: coupling wrench to what the hardware is told to render.
#pragma once

#include "engine/simulation/stages/motion.hpp"

namespace verisim {

void render(const World& world, const Response& response, const Motion& motion);

}  // namespace verisim
