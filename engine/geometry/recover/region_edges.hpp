// Where regions meet: chains of sides between the same two, and the lines, circles and ellipses that they stand for.
#pragma once

#include <vector>

#include "engine/geometry/entity.hpp"
#include "engine/geometry/recover/canonical_mesh.hpp"
#include "engine/geometry/recover/region_search.hpp"

namespace verisim::recover {

/// Edges in the order of their first vertices. Their `faces` are the numbers of the regions, one where the mesh is
/// open. A chain ends where more than two regions meet. @param tolerance  m, of vertices from their curve
[[nodiscard]] std::vector<Edge> edges_between(const CanonicalMesh& mesh, const std::vector<Region>& regions,
                                              double tolerance);

}  // namespace verisim::recover
