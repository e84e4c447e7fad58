// Meshes of STL, OBJ, PLY and glTF files, through assimp with every step off that would change geometry.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "engine/geometry/mesh.hpp"

namespace verisim {

struct MeshObject {
  std::string name;  ///< as the file names it; may be empty
  std::array<float, 4> color = {0.7F, 0.7F, 0.7F, 1};
  TriangleMesh mesh;
};

/// The objects of a file, placed as its nodes say, coordinates times `scale`; polygons are cut into triangles, lines
/// and points left out. Corners are not welded yet. Errors: Error(input) starting with `path`: unknown format, empty,
/// truncated, damaged, no triangles, NaN or infinity.
[[nodiscard]] std::vector<MeshObject> read_mesh_file(const std::string& path, const std::string& content, double scale);

}  // namespace verisim
