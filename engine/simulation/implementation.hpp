// The inside of a Simulation: the world, and what works on it. Private to this folder.
#pragma once

#include "engine/simulation/recording.hpp"
#include "engine/simulation/simulation.hpp"
#include "engine/simulation/stages/left_out.hpp"
#include "engine/simulation/stages/stages.hpp"
#include "engine/simulation/world.hpp"

namespace verisim {

struct Simulation::Implementation {
  Implementation(const Scene& scene, const SimulationOptions& options)
      : world(make_world(scene, options.threads, events)),
        stages(scene, world, events),
        recording(world, stages, cost) {}

  std::vector<Event> events;  ///< first: making the world adds some
  World world;
  FrameCost cost;
  Stages stages;
  Recording recording;
  LeftOut left_out;
  StageTimes stage_ns{};
};

}  // namespace verisim
