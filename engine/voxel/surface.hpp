// The surface voxels of a mesh: the first stage, before inside and outside are known.
#pragma once

#include "engine/voxel/brick_lists.hpp"

namespace verisim {

inline constexpr std::uint32_t kNoSurface = 0xFFFFFFFF;

/// Bricks that hold a surface voxel, ascending, and which of their cells are surface.
struct SurfaceVoxels {
  Eigen::Vector3i bricks = {0, 0, 0};
  std::vector<std::uint32_t> brick;  // (n)       -  brick index
  std::vector<BrickMask> cells;      // (n)       -
  std::vector<std::uint32_t> entry;  // (bricks)  -  a brick's index in the two above, or kNoSurface
  std::uint64_t voxels = 0;
};

/// Marks every voxel whose closed box a triangle touches (triangle_touches_box, 512 voxels at a time).
/// @pre `lists` is of this mesh and of a grid of `bricks` bricks
[[nodiscard]] SurfaceVoxels find_surface(const GridMesh& mesh, const BrickLists& lists, const Eigen::Vector3i& bricks,
                                         unsigned threads);

}  // namespace verisim
