// Inside or outside: connected regions of voxels that no triangle touches, each classified once by its winding number.
//
// Two adjacent untouched voxels (by a face, an edge or a corner) are on the same side: a surface between their centres
// would touch one of the two closed boxes. So one winding number decides a region. It is counted along the segment from
// a voxel to the nearest untouched voxel with smaller x. That voxel's region comes earlier in raster order and is
// known. The segment crosses surface voxels only, so the cost of a region is local.
#pragma once

#include "engine/voxel/surface.hpp"

namespace verisim {

/// The voxels in the material: those with a positive winding number.
struct Sides {
  std::vector<BrickMask>
      inside;  // (surface bricks)  -  as SurfaceVoxels::brick: inside cells; not surface, not outside
  std::vector<std::uint8_t> brick;  // (bricks)          -  1: a brick without surface voxel that is inside
};

/// About 2 us per surface brick and 30 ns per other brick. On a mesh that is not closed the answer is deterministic,
/// but may differ from one region to the next. @pre `lists` and `surface` are of this mesh and of one grid
[[nodiscard]] Sides find_sides(const GridMesh& mesh, const BrickLists& lists, const SurfaceVoxels& surface);

}  // namespace verisim
