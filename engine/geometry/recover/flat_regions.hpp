// Facets by CGAL's region growing: adjacent triangles in one plane. Only flat_regions.cpp includes CGAL.
#pragma once

#include <vector>

#include "engine/geometry/recover/canonical_mesh.hpp"

namespace verisim::recover {

/// Cosine of 1 degree: normals of one facet differ by no more. Slivers are excepted.
inline constexpr double kSameNormal = 0.9998476951563913;
/// Tolerances. A triangle of less height is a sliver: its normal is unreliable.
inline constexpr double kSliver = 20;

/// Facets in the order of their largest triangles, the largest first. Every triangle is in one.
/// @param tolerance  m, of vertices from the facet's plane
[[nodiscard]] std::vector<std::vector<std::uint32_t>> flat_regions(const CanonicalMesh& mesh, double tolerance);

}  // namespace verisim::recover
