// Pairs of triangles of one mesh that cross, exactly decided (CGAL's Polygon Mesh Processing, exact predicates).
#pragma once

#include "engine/geometry/mesh.hpp"

namespace verisim {

struct SelfIntersections {
  std::size_t pairs = 0;              ///< of triangles that meet elsewhere than along a shared edge or corner
  Vector3d where = Vector3d::Zero();  ///< near the first of them [m]
};

/// Any mesh, closed and manifold or not. Touching counts as crossing. Triangles in one common plane never do: rounded
/// coordinates turn slivers over within flat faces (two of the recorded models have hundreds), and no volume changes by
/// it. Degenerate triangles are left out: they have no plane.
/// n log n: 30,000 triangles take about 0.1 s.
/// @pre all vertices finite
[[nodiscard]] SelfIntersections find_self_intersections(const TriangleMesh& mesh);

}  // namespace verisim
