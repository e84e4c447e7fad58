// The edges of a triangle mesh, sorted. Orientation, repair and examination use them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/geometry/mesh.hpp"

namespace verisim {

/// One side of one triangle. `low` and `high` are its vertices in index order; `forward` tells whether the triangle
/// runs from low to high.
struct Side {
  std::uint32_t low = 0;
  std::uint32_t high = 0;
  std::uint32_t triangle = 0;
  bool forward = false;
};

/// All sides, grouped by edge (equal low and high), within a group in triangle order. n log n.
/// Sides between a vertex and itself are left out: they are no edges. Vertices are not asked for.
[[nodiscard]] std::vector<Side> sorted_sides(const TriangleMesh& mesh);

/// Calls visit(span of sides) for every edge, in the order of sorted_sides.
template <typename Visit>
void for_each_edge(std::span<const Side> sides, Visit&& visit) {
  for (std::size_t begin = 0; begin < sides.size();) {
    std::size_t end = begin + 1;
    while (end < sides.size() && sides[end].low == sides[begin].low && sides[end].high == sides[begin].high) ++end;
    visit(sides.subspan(begin, end - begin));
    begin = end;
  }
}

/// For each triangle the number of its component: triangles that share an edge belong together. Numbered from 0 in the
/// order of their first triangles.
struct Components {
  std::vector<std::uint32_t> of_triangle;
  std::uint32_t count = 0;
};
/// @param across_nonmanifold  whether an edge with more than two triangles joins them
/// @pre sides are sorted_sides(mesh)
[[nodiscard]] Components components_of(const TriangleMesh& mesh, std::span<const Side> sides, bool across_nonmanifold);

/// Repeated corners, or a height below 2^-46 of the longest side: nothing that double arithmetic could tell from zero.
[[nodiscard]] bool is_degenerate(const TriangleMesh& mesh, const std::array<std::uint32_t, 3>& triangle);

}  // namespace verisim
