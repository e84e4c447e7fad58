// Conservative voxelization of a closed mesh: every voxel whose closed box a triangle touches is a surface voxel, none
// is missed and none invented (up to 2^-20 of a voxel, to the safe side: a face that lies in a voxel wall marks both
// sides whatever the rounding). Inside and outside come from the winding number, so nested shells and overlapping
// solids work.
//
// Inside is where the winding number is positive. Both results follow the shape, not its tessellation: triangles cut in
// four give the same voxels, layers and points. Cost: about 0.2 us per surface voxel; memory follows surface area.
#pragma once

#include <string>

#include "engine/geometry/mesh.hpp"
#include "engine/voxel/voxmap.hpp"

namespace verisim {

struct VoxelizeOptions {
  double voxel_size = 0;     ///< m
  double point_spacing = 0;  ///< m; 0: one point per surface voxel; else thinned, see Pointshell::voxel
  std::size_t memory_limit = std::size_t{4} << 30;  ///< bytes that the result may take
  unsigned threads = 1;                             ///< same bits for any number
};

/// Is refused before anything is allocated, as Error(input) whose text starts with `name`: a voxel size that is not
/// finite, zero, negative or larger than the part's longest side, or so small that the estimate exceeds the memory
/// limit (the text names the smallest size that fits).
[[nodiscard]] VoxelBody voxelize(const std::string& name, const TriangleMesh& mesh, const VoxelizeOptions& options);

/// Does the closed triangle abc touch the closed box of the given half side around center, within 2^-20 of the half
/// side outward? Separating axes, double arithmetic. All in the same units. Zero-area triangles are segments or points.
/// @pre half_side > 0
[[nodiscard]] bool triangle_touches_box(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& center,
                                        double half_side);

/// Places the grid: per axis the bounding box's faces lie as far from voxel walls as possible (cell centre or cell wall
/// at the box's centre, whichever is better; cell wall if equal), after a border of one brick and up to seven more
/// cells, as many as make the band around both faces fill the fewest bricks. @pre bounds are finite and hold a point;
/// voxel_size is finite and above 0
[[nodiscard]] Vector3d grid_origin(const Bounds& bounds, double voxel_size, Eigen::Vector3i& bricks);

}  // namespace verisim
