// A box on a plate, or inside of it, or several boxes on each other, at any size, mass and place. Judged from poses and
// velocities alone: how deep its corners are, whether it moves aside, and whether it has more energy than it fell for.
#pragma once

#include "engine/simulation/scene.hpp"
#include "engine/stability/row.hpp"

namespace verisim::stability {

struct Resting {
  double size = 0.05;                  ///< m, an edge
  double mass = 0.1;                   ///< kg
  Vector3d offset = Vector3d::Zero();  ///< m, of the whole scene from the origin
  double depth = 0;                    ///< fraction of the edge that is inside of the plate at the beginning
  double gravity = 9.81;               ///< m/s^2
  int boxes = 1;                       ///< flush on each other
  double mass_ratio = 1;               ///< of each box by the one below it
  Hybrid hybrid = hybrid::exact;
  double contact_stiffness = SimulationParameters().contact_stiffness;  ///< N/m
  double exact_stiffness = SimulationParameters().exact_stiffness;      ///< N/m^2
  std::uint64_t frames = 1000;
  double step = 1e-3;
};

/// Expected: no corner deeper than it began by more than a weight presses that is put on its springs at once (exact),
/// or two voxels, no way aside, no energy beyond what was there, to a thousandth of m g edge.
[[nodiscard]] Row rest(const std::string& what, const Resting& resting);

/// Two boxes that are free and begin in one place, without gravity: momentum stays 0, and whatever energy comes of it
/// is told.
[[nodiscard]] Row coincide(Hybrid hybrid);

/// A box whose face touches a plate in `across` times `across` voxels: what the contacts push is its weight.
[[nodiscard]] Row many_contacts(int across, std::uint64_t frames);

}  // namespace verisim::stability
