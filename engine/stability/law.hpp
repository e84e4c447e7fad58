// What the rows of extremes have in common: a scene is run, a law is asked in every frame, and what the engine said
// itself is kept.
#pragma once

#include <functional>
#include <string>

#include "engine/geometry/solid.hpp"
#include "engine/simulation/simulation.hpp"
#include "engine/stability/row.hpp"

namespace verisim::stability {

/// What the engine said of a run: the first event of each kind that tells of something amiss (energy, tunnelling,
/// sinking, spin …); what only tells of what happened is left out. And how it ended, if it did not come to its end.
struct Said {
  std::string events;  ///< "energy: contacts of …; tunnelling: …"; empty: nothing is amiss
  bool refused = false, diverged = false;
};

/// Makes the simulation, steps it, and calls `look` after every frame.
[[nodiscard]] Said run(const std::function<Scene()>& make, std::uint64_t frames,
                       const std::function<void(Simulation&)>& look);

/// Sets outcome and why of a row: refused or diverged as the engine said; else `bounded` false is diverged, `restless`
/// a limit cycle. @param laws  what theory says holds
void conclude(Row& row, const Said& said, bool laws, bool bounded, bool restless);

/// A body made of a solid with its exact faces. Starts the CAD program. @param mass  kg
[[nodiscard]] BodyDescription solid_body(const std::string& name, const Solid& solid, double mass, double voxel_size);
[[nodiscard]] std::shared_ptr<const Solid> box_solid(const Vector3d& size);
[[nodiscard]] std::shared_ptr<const Solid> cylinder_solid(double radius, double height);
[[nodiscard]] Solid difference(std::shared_ptr<const Solid> a, std::shared_ptr<const Solid> b);

}  // namespace verisim::stability
