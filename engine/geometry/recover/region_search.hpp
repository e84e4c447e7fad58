// Segmentation of a mesh into surfaces: which triangles are pieces of one plane, cylinder, cone, sphere or torus.
//
//   1. Seeds     Every facet is a seed, the largest first. Surfaces of each kind are fitted to the facets around it
//                (neighborhoods.hpp).
//   2. Growing   Each fit grows over the mesh and is fitted again (region_growing.hpp). The candidate of the largest
//                area is taken; of equal ones the simplest kind.
//   3. Planes    A facet that borders as a plane does becomes a plane.
//   4. Merging   Regions that lie on a larger surface are merged into it. Patches of a free form are released again
//                (region_merging.hpp).
//   5. The rest  Triangles on no surface become `other` faces, joined where they meet smoothly.
#pragma once

#include <vector>

#include "engine/geometry/entity.hpp"
#include "engine/geometry/recover.hpp"
#include "engine/geometry/recover/canonical_mesh.hpp"

namespace verisim::recover {

struct Region {
  Surface surface;                       ///< OtherSurface: no surface fits
  std::vector<std::uint32_t> triangles;  ///< ascending, connected by sides
};

/// Every triangle is in one region.
/// @param tolerance   m, of vertices from their surface
/// @param round_step  rad, the largest angle between neighbouring facets of one curved surface
/// @pre the tolerance is finite and above 0; so is the step
[[nodiscard]] std::vector<Region> find_regions(const CanonicalMesh& mesh, double tolerance, double round_step,
                                               const RecoverThresholds& thresholds);

}  // namespace verisim::recover
