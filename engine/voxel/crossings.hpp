// Signed crossings of a closed surface by a segment along x, robust against hitting edges and corners.
#pragma once

#include "engine/voxel/brick_lists.hpp"

namespace verisim {

/// Change of the winding number along the segment from the centre of cell `from` along +x to the cell at `to_x` in the
/// same row: +1 where the segment enters a shell, -1 where it leaves one. @pre the mesh touches neither cell;
/// both are in the grid, `to_x` not before `from`
[[nodiscard]] int winding_change(const GridMesh& mesh, const BrickLists& lists, const Eigen::Vector3i& bricks,
                                 const Eigen::Vector3i& from, int to_x);

}  // namespace verisim
