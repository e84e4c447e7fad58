// Limits of voxelization: checks of the input, and the memory that the result will take.
#pragma once

#include <string>

#include "engine/voxel/voxelize.hpp"

namespace verisim {

/// Bounds of the corners that triangles use. Throws Error(input) for a mesh without triangles, a corner that is NaN or
/// infinite, and a triangle that names a corner that does not exist.
[[nodiscard]] Bounds checked_bounds(const std::string& name, const TriangleMesh& mesh);

/// Bytes of voxmap and pointshell, to about 20 % for a part much larger than a voxel, before anything is allocated. A
/// plane with unit normal n passes through (|nx| + |ny| + |nz|) / voxel_size^2 voxels per area.
class MemoryEstimate {
 public:
  MemoryEstimate(const TriangleMesh& mesh, const Bounds& bounds);
  [[nodiscard]] double bytes(double voxel_size) const;  ///< @pre voxel_size > 0
  /// The smallest voxel size, rounded up to two digits, whose estimate is within the limit. @pre the mesh is no point
  [[nodiscard]] double smallest_size(double limit) const;

 private:
  double projected_area_ = 0;  // sum of area (|nx| + |ny| + |nz|) [m^2]
  Vector3d size_;              // of the bounding box [m]
};

/// Throws the refusals that voxelize() promises.
void check_voxel_size(const std::string& name, const TriangleMesh& mesh, const Bounds& bounds,
                      const VoxelizeOptions& options);

/// Throws if the result, now counted exactly, exceeds the limit after all.
void check_result_size(const std::string& name, const TriangleMesh& mesh, const Bounds& bounds,
                       const VoxelizeOptions& options, double bytes);

}  // namespace verisim
