// A mesh in an order that depends on its shape alone: vertices by their coordinates, triangles by their vertices. What
// is computed from it is the same whatever order a file lists triangles in.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/geometry/mesh.hpp"

namespace verisim::recover {

inline constexpr std::uint32_t kNone = kNoFace;

struct CanonicalMesh {
  std::vector<Vector3d> vertices;                       // ascending (x, y, z), none twice
  std::vector<std::array<std::uint32_t, 3>> triangles;  // smallest vertex first, ascending
  std::vector<std::array<std::uint32_t, 3>> neighbors;  // across the side from corner i to i + 1; kNone: not one alone
  std::vector<Vector3d> normals;
  std::vector<Vector3d> centers;
  std::vector<double> areas;
  std::vector<double> heights;          // the smallest of the three
  std::vector<std::uint32_t> of_given;  // (given triangles): its number here; kNone: without area
  double size = 0;                      // m, diagonal of the bounding box

  [[nodiscard]] const Vector3d& corner(std::uint32_t triangle, std::size_t i) const {
    return vertices[triangles[triangle][i]];
  }
};

[[nodiscard]] CanonicalMesh canonical(const TriangleMesh& mesh);

}  // namespace verisim::recover
