// Signed crossings of a closed surface by a segment along x, robust against hitting edges and corners.
#pragma once

#include "engine/voxel/brick_lists.hpp"

namespace verisim {

/// By how much the winding number changes on the way from the centre of cell `from` along +x to the cell at `to_x` in
/// the same row: +1 where the way enters a shell, -1 where it leaves one. Both cells must be untouched by the mesh.
/// @pre both cells are in the grid, `to_x` not before `from`
[[nodiscard]] int winding_change(const GridMesh& mesh, const BrickLists& lists, const Eigen::Vector3i& bricks,
                                 const Eigen::Vector3i& from, int to_x);

}  // namespace verisim
