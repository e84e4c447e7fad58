// Where the handles are, and who holds what: by the button, or said outright by grasp().
#pragma once

#include <vector>

#include "engine/simulation/stages/notes.hpp"
#include "engine/simulation/world.hpp"

namespace verisim {

class Grasping {
 public:
  /// Grasps of the scene are taken in the first frame, when the handles have been sampled.
  Grasping(std::vector<Grasp> first_grasps, double grasp_distance)
      : first_grasps_(std::move(first_grasps)), distance_(grasp_distance) {}

  /// Raw pose to virtual handle, of every device. Error(diverged) for one that is not finite.
  void sample(World& world);
  /// Takes and lets go as the buttons say. Notes: grasp, release.
  void update(World& world, Notes& notes);

  static void take(World& world, std::size_t hand, std::size_t body, bool by_script, Notes& notes);
  static void let_go(World& world, std::size_t hand, Notes& notes);

 private:
  [[nodiscard]] std::size_t nearest_body(const World& world, const Vector3d& p_W) const;

  std::vector<Grasp> first_grasps_;
  double distance_;  ///< m, handle to body's nearest point
};

/// Where a hand wants the body that it holds, and how fast that place moves.
/// @pre the hand holds one
[[nodiscard]] CouplingTarget target_of(const World& world, std::size_t hand);

}  // namespace verisim
