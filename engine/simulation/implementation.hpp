// The inside of a Simulation: the world, and what works on it. Private to this folder.
#pragma once

#include "engine/simulation/body_maker.hpp"
#include "engine/simulation/recording.hpp"
#include "engine/simulation/simulation.hpp"
#include "engine/simulation/stages/left_out.hpp"
#include "engine/simulation/stages/notes.hpp"
#include "engine/simulation/stages/stages.hpp"
#include "engine/simulation/world.hpp"

namespace verisim {

struct Simulation::Implementation {
  Implementation(Scene scene, const SimulationOptions& options)
      : world(make_world(scene, events)),
        stages(scene, world),
        maker(std::move(scene.bodies), options.threads, options.store),
        recording(world, stages, cost) {
    notes.make_room(world, 0);
    maker.begin(world);
    stages.neighbours.make_room(world);
    look_around();
  }

  void look_around() { stages.neighbours.look_around(world); }
  /// Between frames.
  void tell() { notes.tell(world, events); }
  std::size_t add_link(std::size_t first, std::size_t second);
  void meet(std::size_t first, std::size_t second);

  std::vector<Event> events;  ///< first: making the world adds some
  World world;
  Notes notes;
  FrameCost cost;
  Stages stages;
  BodyMaker maker;
  Recording recording;
  LeftOut left_out;
  StageTimes stage_ns{};
  std::vector<BodyPair> met;     ///< pairs in the order in which they came near
  std::uint64_t met_before = 0;  ///< how many of them when the last frame ended
  bool poses_set = false;        ///< since the last look around
};

}  // namespace verisim
