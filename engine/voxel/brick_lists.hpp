// Lists of the triangles that pass through each brick. Each triangle is refined down a hierarchy of cubes of 8^k
// voxels, so the cost follows its area. Later stages do not depend on the size of triangles.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/geometry/mesh.hpp"
#include "engine/voxel/overlap.hpp"

namespace verisim {

/// A mesh in grid coordinates.
struct GridMesh {
  std::vector<Vector3d> vertices;                              // (n) voxel
  const std::vector<std::array<std::uint32_t, 3>>* triangles;  // (m) -      of the caller's mesh
  [[nodiscard]] std::array<Vector3d, 3> corners(std::uint32_t triangle) const {
    const auto& [a, b, c] = (*triangles)[triangle];
    return {vertices[a], vertices[b], vertices[c]};
  }
};

/// The mesh in the grid coordinates of a map. @pre the map has a voxel size
[[nodiscard]] GridMesh in_grid_coordinates(const TriangleMesh& mesh, const Voxmap& map);

/// For every brick the triangles, ascending, that touch it (grown by a margin; a few more may be listed).
struct BrickLists {
  std::vector<std::uint32_t> begin;     // (bricks + 1)  -  the brick's first entry in `triangle`
  std::vector<std::uint32_t> triangle;  // (entries)     -
  [[nodiscard]] std::span<const std::uint32_t> of(std::size_t brick) const {
    return {triangle.data() + begin[brick], begin[brick + 1] - begin[brick]};
  }
  [[nodiscard]] bool empty(std::size_t brick) const { return begin[brick] == begin[brick + 1]; }
};

/// @param margin  by how much bricks are grown [voxel]
/// @pre every corner of a triangle lies within the grid of `bricks` bricks, and farther than the margin from its walls;
/// margin >= 0
[[nodiscard]] BrickLists list_triangles_by_brick(const GridMesh& mesh, const Eigen::Vector3i& bricks,
                                                 double margin = kCandidateMargin);

/// Lower corner of a brick [voxel].
[[nodiscard]] inline Eigen::Vector3i brick_corner(std::size_t brick, const Eigen::Vector3i& bricks) {
  const auto nx = static_cast<std::size_t>(bricks.x()), ny = static_cast<std::size_t>(bricks.y());
  return kBrickSide * Eigen::Vector3i(static_cast<int>(brick % nx), static_cast<int>(brick / nx % ny),
                                      static_cast<int>(brick / nx / ny));
}

[[nodiscard]] inline std::size_t brick_index(int x, int y, int z, const Eigen::Vector3i& bricks) {
  const auto size = [](int i) { return static_cast<std::size_t>(i); };
  return (size(z) * size(bricks.y()) + size(y)) * size(bricks.x()) + size(x);
}

}  // namespace verisim
