// From regions to faces: the surface with the bounds that its triangles have on it.
#pragma once

#include "engine/geometry/entity.hpp"
#include "engine/geometry/recover/canonical_mesh.hpp"
#include "engine/geometry/recover/region_search.hpp"

namespace verisim::recover {

/// The area is that of the triangles. Edges are left out.
[[nodiscard]] Face face_of(const CanonicalMesh& mesh, const Region& region);

}  // namespace verisim::recover
