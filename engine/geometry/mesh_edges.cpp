#include "engine/geometry/mesh_edges.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "engine/base/error.hpp"

namespace verisim {
namespace {

/// Disjoint sets whose representative is always the smallest member, so that numbering does not depend on merge order.
class Sets {
 public:
  explicit Sets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0U); }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace

std::vector<Side> sorted_sides(const TriangleMesh& mesh) {
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (unsigned corner = 0; corner < 3; ++corner) {
      const std::uint32_t from = mesh.triangles[t][corner];
      const std::uint32_t to = mesh.triangles[t][(corner + 1) % 3];
      if (from != to) sides.push_back({std::min(from, to), std::max(from, to), t, from < to});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.triangle, a.forward) < std::tie(b.low, b.high, b.triangle, b.forward);
  });
  return sides;
}

Components components_of(const TriangleMesh& mesh, std::span<const Side> sides, bool across_nonmanifold) {
  VERISIM_ASSERT(sides.size() <= 3 * mesh.triangles.size());
  for (const Side& side : sides) VERISIM_ASSERT(side.triangle < mesh.triangles.size());
  Sets sets(mesh.triangles.size());
  for_each_edge(sides, [&](std::span<const Side> edge) {
    if (edge.size() > 2 && !across_nonmanifold) return;
    for (const Side& side : edge.subspan(1)) sets.join(edge.front().triangle, side.triangle);
  });
  Components components;
  components.of_triangle.resize(mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::uint32_t first = sets.find(t);
    components.of_triangle[t] = first == t ? components.count++ : components.of_triangle[first];
  }
  return components;
}

bool is_degenerate(const TriangleMesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
  const auto [i, j, k] = triangle;
  if (i == j || j == k || k == i) return true;
  const Vector3d ab = mesh.vertices[j] - mesh.vertices[i];
  const Vector3d ac = mesh.vertices[k] - mesh.vertices[i];
  const double longest_squared = std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
  return ab.cross(ac).norm() <= 0x1p-46 * longest_squared;
}

}  // namespace verisim
