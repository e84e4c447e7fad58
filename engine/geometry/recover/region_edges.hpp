// The edges between regions: chains of mesh sides between the same two regions, and the curves that they stand for.
#pragma once

#include <vector>

#include "engine/geometry/entity.hpp"
#include "engine/geometry/recover/canonical_mesh.hpp"
#include "engine/geometry/recover/region_search.hpp"

namespace verisim::recover {

/// Edges in the order of their first vertices. Edge::faces holds the numbers of the regions; one where the mesh is
/// open. A chain ends where more than two regions meet. @param tolerance  m, of vertices from their curve
[[nodiscard]] std::vector<Edge> edges_between(const CanonicalMesh& mesh, const std::vector<Region>& regions,
                                              double tolerance, const RecoverThresholds& thresholds);

}  // namespace verisim::recover
