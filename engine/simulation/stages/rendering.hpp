// What the hands feel: coupling wrench to what the hardware is told to render, and what touches what they hold.
#pragma once

#include "engine/simulation/stages/contacts.hpp"
#include "engine/simulation/stages/exact_response.hpp"
#include "engine/simulation/stages/motion.hpp"
#include "engine/simulation/stages/notes.hpp"

namespace verisim {

/// Notes: collision, when one starts (CollisionStart); coupling, when it turns round; and what devices report.
void render(World& world, const Contacts& contacts, const ExactResponse& exact, const Response& response,
            const Motion& motion, Notes& notes);

}  // namespace verisim
