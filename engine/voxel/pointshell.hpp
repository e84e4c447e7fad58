// Builds the pointshell of a voxmap: one point per surface voxel, or fewer.
#pragma once

#include "engine/voxel/surface.hpp"
#include "engine/voxel/voxmap.hpp"

namespace verisim {

/// One point per surface voxel, in the voxmap's order; one cluster per surface brick.
/// @pre mesh, lists, surface and map belong together; the reference is finite
[[nodiscard]] Pointshell make_pointshell(const GridMesh& mesh, const BrickLists& lists, const SurfaceVoxels& surface,
                                         const Voxmap& map, const Vector3d& reference, unsigned threads);

/// Keeps one point per cube of side `spacing` (a lattice from the grid's origin) and main direction of the normal: the
/// one nearest to the cube's centre, of equal ones the first. With six directions both sides of a thin wall are kept.
/// Sorted by groups of 8 x 8 x 8 cubes (z, y, x), then by voxel number; a group is a cluster, cut where it has more
/// than 512 points.
/// @pre the shell has one point per surface voxel of the map; spacing is finite and above 0
[[nodiscard]] Pointshell thinned(const Pointshell& shell, const Voxmap& map, double spacing);

}  // namespace verisim
