// The stages of a frame. Each owns what it keeps per body and per link, and is the only one to write it; the others
// read it through its functions. Simulation::step calls them in their order.
#pragma once

#include "engine/simulation/stages/contacts.hpp"
#include "engine/simulation/stages/energy.hpp"
#include "engine/simulation/stages/exact_response.hpp"
#include "engine/simulation/stages/grasping.hpp"
#include "engine/simulation/stages/motion.hpp"
#include "engine/simulation/stages/pair_methods.hpp"
#include "engine/simulation/stages/passivity.hpp"
#include "engine/simulation/stages/reactions.hpp"
#include "engine/simulation/stages/response.hpp"

namespace verisim {

struct Stages {
  Stages(const Scene& scene, const World& world, std::vector<Event>& events)
      : grasping(scene.grasps, scene.grasp_distance),
        energy(world),
        contacts(world),
        methods(world, contacts, events),
        response(world),
        exact(world, methods),
        passivity(world),
        motion(world),
        reactions(world) {}

  Grasping grasping;
  EnergyBook energy;
  Contacts contacts;
  PairMethods methods;
  Response response;
  ExactResponse exact;
  Passivity passivity;
  Motion motion;
  Reactions reactions;
};

}  // namespace verisim
