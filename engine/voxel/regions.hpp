// Inside or outside: connected regions of voxels that no triangle touches, each classified once by its winding number.
//
// Two untouched voxels that share a face, an edge or a corner are on the same side: on the segment between their
// centres a surface would pass through one of the two closed boxes. So one winding number decides a region. It is
// counted from a voxel to the nearest untouched voxel with smaller x, whose region comes earlier in raster order and is
// known; the segment between them crosses surface voxels only, so the cost of a region is local, however many there
// are.
#pragma once

#include "engine/voxel/surface.hpp"

namespace verisim {

/// Which voxels are in the material. Inside: the winding number is positive.
struct Sides {
  std::vector<BrickMask>
      inside;  // (surface bricks)  -  as SurfaceVoxels::brick: inside cells; not surface, not outside
  std::vector<std::uint8_t> brick;  // (bricks)          -  1: a brick without surface voxel that is inside
};

/// About 2 us per surface brick and 30 ns per other brick. On a mesh that is not closed the answer is deterministic,
/// but may differ from one region to the next. @pre `lists` and `surface` are of this mesh and of one grid
[[nodiscard]] Sides find_sides(const GridMesh& mesh, const BrickLists& lists, const SurfaceVoxels& surface);

}  // namespace verisim
