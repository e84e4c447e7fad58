// From facets to surfaces: which triangles are pieces of one plane, cylinder, cone, sphere or torus.
//
// From every facet, the largest first, surfaces of each kind are fitted to what lies around it, grown over the mesh as
// long as vertices lie on them, fitted again to all that they cover, and grown again. The one that covers most is
// taken; of equals the simplest. What is flat and borders as a plane does becomes a plane. Then second thoughts (what
// a larger surface explains as well, what is a patch of a free form); what fits nothing stays.
#pragma once

#include <vector>

#include "engine/geometry/entity.hpp"
#include "engine/geometry/recover.hpp"
#include "engine/geometry/recover/canonical_mesh.hpp"

namespace verisim::recover {

struct Region {
  Surface surface;                       ///< OtherSurface for what fits nothing
  std::vector<std::uint32_t> triangles;  ///< ascending, joined by sides
};

/// Every triangle is in one region. @param tolerance  m, of vertices from their surface  @param round_step  rad, the
/// largest angle at which facets meet that can be pieces of one round surface
/// @pre the tolerance is finite and above 0; so is the step
[[nodiscard]] std::vector<Region> find_regions(const CanonicalMesh& mesh, double tolerance, double round_step,
                                               const RecoverThresholds& thresholds);

}  // namespace verisim::recover
