// Pairs of triangles of one mesh that cross, exactly decided (CGAL's Polygon Mesh Processing, exact predicates).
#pragma once

#include "engine/geometry/mesh.hpp"

namespace verisim {

struct SelfIntersections {
  std::size_t pairs = 0;              ///< of triangles that meet elsewhere than along a shared edge or corner
  Vector3d where = Vector3d::Zero();  ///< near the first of them [m]
};

/// Any mesh, closed and manifold or not. A pair counts if one triangle reaches through the other's plane by more than
/// 1/2000 of the mesh's diagonal or a twentieth of the longer triangle, whichever is less. So pairs in one plane never
/// count, nor do slivers that rounding or tessellation pushed over a rim. Two of the recorded models have hundreds of
/// those; they hardly change the volume. Degenerate triangles are left out: they have no plane. n log n: 30,000
/// triangles take about 0.1 s.
/// @pre is_whole(mesh), all vertices finite
[[nodiscard]] SelfIntersections find_self_intersections(const TriangleMesh& mesh);

}  // namespace verisim
