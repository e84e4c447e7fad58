// Facets by CGAL's region growing: adjacent triangles in one plane. Only flat_regions.cpp includes CGAL.
#pragma once

#include <vector>

#include "engine/geometry/recover.hpp"
#include "engine/geometry/recover/canonical_mesh.hpp"

namespace verisim::recover {

/// Facets in the order of their largest triangles, the largest first. Every triangle is in one.
/// Normals of a facet are the same to thresholds.same_normal, those of slivers excepted.
/// @param tolerance  m, of vertices from the facet's plane
[[nodiscard]] std::vector<std::vector<std::uint32_t>> flat_regions(const CanonicalMesh& mesh, double tolerance,
                                                                   const RecoverThresholds& thresholds);

}  // namespace verisim::recover
