// The face of a region: its surface with the parameter ranges that its triangles cover (engine/geometry/entity.hpp).
#pragma once

#include "engine/geometry/entity.hpp"
#include "engine/geometry/recover/canonical_mesh.hpp"
#include "engine/geometry/recover/region_search.hpp"

namespace verisim::recover {

/// Face::area is that of the triangles. Face::edges stays empty.
[[nodiscard]] Face face_of(const CanonicalMesh& mesh, const Region& region);

}  // namespace verisim::recover
