// The triangles of a shape, watertight by construction: two faces have the same vertices along a common edge, because
// the points of each edge are numbered once, from the kernel's polygons on triangulations.
#pragma once

#include <TopTools_IndexedMapOfShape.hxx>

#include "engine/geometry/mesh.hpp"

namespace verisim::cad {

struct Tessellation {
  TriangleMesh mesh;                                ///< face_of_triangle counts from 0, in the order of `faces`
  std::vector<std::vector<std::uint32_t>> of_edge;  ///< vertices along each edge of `edges`, with growing parameter
  std::size_t faces_without_triangles = 0;
};

/// @param shape  as the kernel's mesher left it
/// @param faces, edges  indexed maps of `shape`
/// @param unit  metres per kernel length; coordinates are rounded (rounding.hpp)
[[nodiscard]] Tessellation tessellation_of(const TopTools_IndexedMapOfShape& faces,
                                           const TopTools_IndexedMapOfShape& edges, double unit);

}  // namespace verisim::cad
