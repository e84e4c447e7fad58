// The stages of a frame. Each owns what it keeps per body and per link, and is the only one to write it; the others
// read it through its functions. Simulation::step calls them in their order.
#pragma once

#include "engine/simulation/stages/busy.hpp"
#include "engine/simulation/stages/contacts.hpp"
#include "engine/simulation/stages/energy.hpp"
#include "engine/simulation/stages/exact_response.hpp"
#include "engine/simulation/stages/grasping.hpp"
#include "engine/simulation/stages/motion.hpp"
#include "engine/simulation/stages/neighbours.hpp"
#include "engine/simulation/stages/pair_energy.hpp"
#include "engine/simulation/stages/pair_methods.hpp"
#include "engine/simulation/stages/passivity.hpp"
#include "engine/simulation/stages/reactions.hpp"
#include "engine/simulation/stages/response.hpp"
#include "engine/simulation/stages/sinking.hpp"
#include "engine/simulation/stages/tunnelling.hpp"

namespace verisim {

struct Stages {
  Stages(const Scene& scene, const World& world)
      : grasping(scene.grasps, scene.grasp_distance),
        busy(world),
        energy(world),
        contacts(world),
        response(world),
        exact(world),
        passivity(world),
        motion(world),
        reactions(world),
        tunnelling(world),
        sinking(world),
        neighbours(world) {}

  /// Between frames: what each keeps of a link. @pre its bodies are made
  void add_link(const World& world, std::size_t link) {
    contacts.add_link(world, link);
    methods.add_link(world, contacts, link);
    response.add_link();
    exact.add_link(world, methods, link);
    passivity.add_link();
    reactions.add_link();
    pair_energy.add_link();
    neighbours.add_link(world, link);
  }

  Grasping grasping;
  Busy busy;
  EnergyBook energy;
  Contacts contacts;
  PairMethods methods;
  Response response;
  ExactResponse exact;
  Passivity passivity;
  Motion motion;
  Reactions reactions;
  Tunnelling tunnelling;
  Sinking sinking;
  PairEnergy pair_energy;
  Neighbours neighbours;
};

}  // namespace verisim
