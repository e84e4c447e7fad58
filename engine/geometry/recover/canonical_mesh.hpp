// A triangle mesh in canonical order: vertices sorted by their coordinates, triangles by their vertices. What is
// computed from it does not depend on the order in which a file lists triangles and vertices. Part coordinates [m].
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/geometry/mesh.hpp"

namespace verisim::recover {

inline constexpr std::uint32_t kNone = kNoFace;

struct CanonicalMesh {
  std::vector<Vector3d> vertices;                       // m, ascending (x, y, z), none twice
  std::vector<std::array<std::uint32_t, 3>> triangles;  // smallest vertex first, ascending
  std::vector<std::array<std::uint32_t, 3>>
      neighbors;                        // across the side from corner i to i + 1; kNone: none or several
  std::vector<Vector3d> normals;        // per triangle, unit
  std::vector<Vector3d> centers;        // per triangle, m
  std::vector<double> areas;            // per triangle, m^2
  std::vector<double> heights;          // per triangle, m: the smallest of the three
  std::vector<std::uint32_t> of_given;  // (given triangles) number here; kNone: without area
  double size = 0;                      // m, diagonal of the bounding box

  [[nodiscard]] const Vector3d& corner(std::uint32_t triangle, std::size_t i) const {
    return vertices[triangles[triangle][i]];
  }
};

/// Removes triangles without area and those that occur twice. O(n log n).
/// @pre is_whole(mesh), all vertices finite
[[nodiscard]] CanonicalMesh canonical(const TriangleMesh& mesh);

}  // namespace verisim::recover
