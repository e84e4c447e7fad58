// Merges several solids that move as one into one part: meshes, faces and edges one after the other.
#pragma once

#include <vector>

#include "engine/geometry/part.hpp"

namespace verisim {

/// Triangles know their faces and faces their edges as before. Volume, centroid and inertia together (parallel axis
/// theorem); watertight if all are. Name and colour are the first part's. @pre parts is not empty; triangles know
/// their faces all or none
[[nodiscard]] Part merged(const std::vector<Part>& parts);

}  // namespace verisim
