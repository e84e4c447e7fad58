// Conservative voxelization of a closed mesh. A voxel is a surface voxel if a triangle touches its closed box, grown by
// 2^-20 of a voxel: a face in a voxel wall marks both sides, whatever the rounding. Inside is where the winding number
// is positive, so nested shells and overlapping solids work.
//
// The result depends on the shape, not on its tessellation: subdivided triangles give the same voxels, layers and
// points. Cost: about 0.2 us per surface voxel; memory follows surface area.
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

/// Throws Error(input), with a text that starts with `name`, before allocation: for a voxel size that is not finite,
/// not positive, larger than the part's longest side, or so small that the estimate exceeds the memory limit (the text
/// names the smallest size that fits).
[[nodiscard]] VoxelBody voxelize(const std::string& name, const TriangleMesh& mesh, const VoxelizeOptions& options);

/// True if the closed triangle abc touches the closed box of the given half side around center, grown by 2^-20 of the
/// half side. Separating axes, double arithmetic. All in the same units. Zero-area triangles are segments or points.
/// @pre half_side > 0
[[nodiscard]] bool triangle_touches_box(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& center,
                                        double half_side);

/// Places the grid. Per axis the bounding box's faces lie as far from voxel walls as possible: a cell centre or a cell
/// wall is at the box's centre, whichever is better (cell wall if equal). The border is one brick and up to seven more
/// cells, so that the band around both faces fills the fewest bricks.
/// @pre bounds are finite and hold a point; voxel_size is finite and above 0
[[nodiscard]] Vector3d grid_origin(const Bounds& bounds, double voxel_size, Eigen::Vector3i& bricks);

}  // namespace verisim
