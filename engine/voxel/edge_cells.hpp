// The voxels that an edge may pass through and those near it, found brick by brick along the curve.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/voxel/brick_mask.hpp"
#include "engine/voxel/grid_curve.hpp"

namespace verisim {

/// One edge in one brick.
struct EdgeCells {
  std::uint32_t brick;     ///< index among the bricks with surface voxels
  std::uint32_t edge;      ///< of the part
  BrickMask candidates{};  ///< a superset of the voxels that the edge passes through
  BrickMask near{};        ///< a superset of the voxels whose centres are within the edge's distance
};

/// For every brick that holds a surface voxel, the edges that come near it, ascending.
class EdgeLists {
 public:
  /// @param entry_of_brick  a brick's index among those with surface voxels, or kNoSurface
  /// @param distances       for each edge: how far `near` reaches [voxel]
  /// @pre a distance for each curve, finite and not negative; an entry for each brick
  /// About 0.1 us per voxel length of edge, more where `distances` are large.
  EdgeLists(const std::vector<GridCurve>& curves, const std::vector<double>& distances, const Eigen::Vector3i& bricks,
            const std::vector<std::uint32_t>& entry_of_brick, std::size_t entries);

  [[nodiscard]] std::span<const EdgeCells> of(std::size_t entry) const {
    return {cells_.data() + begin_[entry], begin_[entry + 1] - begin_[entry]};
  }

 private:
  std::vector<EdgeCells> cells_;
  std::vector<std::size_t> begin_;  // (entries + 1)
};

}  // namespace verisim
