// The faces of a part as the association asks them: surface and bounds in grid coordinates, and how far the triangles
// are from them.
#pragma once

#include <memory>
#include <vector>

#include "engine/geometry/part.hpp"
#include "engine/voxel/brick_lists.hpp"
#include "engine/voxel/grid_surface.hpp"
#include "engine/voxel/trim.hpp"

namespace verisim {

/// Closed boxes of voxels reach this far beyond half a voxel, as those of the voxelizer do.
inline constexpr double kBoxHalf = 0.5 * (1 + kTouchTolerance);

struct PreparedFace {
  std::unique_ptr<const GridSurface> surface;  ///< none: it has no equation
  std::unique_ptr<const FaceTrim> trim;        ///< none: the face is known by its triangles
  double deflection = 0;  ///< no point of the face is farther from its triangles [voxel], nor they from it
  double nearness = 0;    ///< bounds that are farther from a voxel's centre than this cannot matter to it
  bool is_loose = false;  ///< its surface is known, but its bounds are of no use
};

/// About 10 ns per triangle and 10 us per face.
/// @param mesh  of the part, in the map's grid coordinates
[[nodiscard]] std::vector<PreparedFace> prepare_faces(const Part& part, const GridMesh& mesh, const Voxmap& map);

}  // namespace verisim
