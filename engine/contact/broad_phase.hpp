// Broad phase: the pairs of bodies that may be near enough to be queried. FCL's dynamic AABB tree over one box per
// body.
//
// World coordinates. Pairs are (i, j), i < j, in ascending order, so that later sums have an order. Pairs of two bodies
// that cannot move are left out. find() allocates nothing: pairs for which there is no room are left out and counted.
//
// The tree's boxes are larger than they need to be. While a body stays in its box nothing changes, so a frame costs
// what leaves its box. Which pairs are found besides those whose boxes meet depends on where the bodies came from.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "engine/base/pose.hpp"

namespace verisim {

struct BroadPhaseBody {
  Vector3d center_B;  ///< m, of the box around the body, body coordinates
  Vector3d half_B;    ///< m, half sides, grown by the reach of the narrow phase beyond the surface
  bool can_move;
};

class BroadPhase {
 public:
  /// @pre boxes are finite, half sides not negative
  explicit BroadPhase(const std::vector<BroadPhaseBody>& bodies);
  ~BroadPhase();

  /// `ahead`: m, by which the box is larger on every side. A body that cannot move may be placed until the first
  /// find().
  /// @pre body is one of those given to the constructor; X_WB is finite, its rotation unit; ahead is finite, not
  /// negative
  void set_pose(std::size_t body, const Pose& X_WB, double ahead);
  /// All pairs whose boxes meet, and others that are about as near as that; valid until the next call.
  [[nodiscard]] const std::vector<std::pair<std::uint32_t, std::uint32_t>>& find();
  /// Pairs for which there was no room when they were found. The others stay as they are until make_room().
  [[nodiscard]] std::size_t left_out() const;
  /// Makes room for twice as many as there were; the next find() looks at all bodies. Returns for how many. Allocates.
  std::size_t make_room();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace verisim
