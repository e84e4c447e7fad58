// How deep one body is inside of another, for bodies that begin so: a lower bound from their voxels.
//
// A point of B's shell is the centre of a voxel that B's surface passes through. In a voxel of A of layer -k it is
// k - 1 of A's voxels or more below A's surface. So B's surface is at least
//     (k - 1) s_A - sqrt(3)/2 s_B
// below it (s: voxel sizes). A body that touches, or overlaps by less than a voxel, gives 0: precise contacts tell of
// that themselves.
#pragma once

#include "engine/voxel/voxmap.hpp"

namespace verisim {

/// @returns m, the largest such bound of all points, of either body in the other; 0: none is known to be inside. X_AB
/// places B in A. Beyond layer -(kBand + 1) nothing is counted: kBand voxels at most. Allocates: between frames.
/// Cost: two queries (query.hpp), and 50 bytes per point of the shells.
[[nodiscard]] double depth_inside(const VoxelBody& a, const VoxelBody& b, const Pose& X_AB);

}  // namespace verisim
