// Facets: triangles side by side in one plane. Grown with CGAL's region growing; flat_regions.cpp alone includes it.
#pragma once

#include <vector>

#include "engine/geometry/recover/canonical_mesh.hpp"

namespace verisim::recover {

/// Triangles that differ by more than this are not of one facet, unless one of them is a sliver.
inline constexpr double kSameNormal = 0.9998476951563913;  // cosine of 1 degree
/// A triangle is a sliver, with a normal that says nothing, if it is lower than this many tolerances.
inline constexpr double kSliver = 20;

/// Every triangle is in one facet. Facets in the order of their largest triangles, the largest first.
/// @param tolerance  m, of vertices from the facet's plane
[[nodiscard]] std::vector<std::vector<std::uint32_t>> flat_regions(const CanonicalMesh& mesh, double tolerance);

}  // namespace verisim::recover
