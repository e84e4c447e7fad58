#include "engine/geometry/recover/canonical_mesh.hpp"

#include <algorithm>
#include <numeric>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/geometry/mesh_edges.hpp"

namespace verisim::recover {

namespace {

bool comes_before(const Vector3d& a, const Vector3d& b) {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
}

/// Fills mesh.vertices. @returns for each given vertex its number there
std::vector<std::uint32_t> sort_vertices(const std::vector<Vector3d>& given, CanonicalMesh& mesh) {
  std::vector<std::uint32_t> order(given.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) { return comes_before(given[a], given[b]); });
  std::vector<std::uint32_t> number(given.size());
  for (const std::uint32_t v : order) {
    if (mesh.vertices.empty() || mesh.vertices.back() != given[v]) mesh.vertices.push_back(given[v]);
    number[v] = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  }
  return number;
}

void measure(CanonicalMesh& mesh) {
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vector3d &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
    const Vector3d cross = (q - p).cross(r - p);
    const double twice_area = cross.norm();
    mesh.normals.emplace_back(twice_area > 0 ? Vector3d(cross / twice_area) : Vector3d::Zero());
    mesh.areas.push_back(0.5 * twice_area);
    mesh.centers.emplace_back((p + q + r) / 3);
    mesh.heights.push_back(twice_area / std::max({(q - p).norm(), (r - q).norm(), (p - r).norm()}));
  }
}

void join_neighbors(CanonicalMesh& mesh) {
  mesh.neighbors.assign(mesh.triangles.size(), {kNone, kNone, kNone});
  TriangleMesh plain;
  plain.triangles = mesh.triangles;
  const std::vector<Side> sides = sorted_sides(plain);
  for_each_edge(sides, [&](std::span<const Side> edge) {
    if (edge.size() != 2) return;
    for (std::size_t i = 0; i < 2; ++i) {
      const auto& triangle = mesh.triangles[edge[i].triangle];
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [low, high] = std::minmax(triangle[k], triangle[(k + 1) % 3]);
        if (low == edge[i].low && high == edge[i].high) mesh.neighbors[edge[i].triangle][k] = edge[1 - i].triangle;
      }
    }
  });
}

}  // namespace

CanonicalMesh canonical(const TriangleMesh& given) {
  VERISIM_ASSERT(is_whole(given));
  for (const Vector3d& v : given.vertices) VERISIM_ASSERT(is_finite(v));  // they are sorted
  CanonicalMesh mesh;
  const std::vector<std::uint32_t> number = sort_vertices(given.vertices, mesh);
  std::vector<std::array<std::uint32_t, 3>> renamed;
  for (const auto& corners : given.triangles) {
    std::array<std::uint32_t, 3> t = {number[corners[0]], number[corners[1]], number[corners[2]]};
    std::rotate(t.begin(), std::ranges::min_element(t), t.end());
    renamed.push_back(t);
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) mesh.triangles.push_back(t);
  }
  std::ranges::sort(mesh.triangles);
  mesh.triangles.erase(std::unique(mesh.triangles.begin(), mesh.triangles.end()), mesh.triangles.end());
  for (const auto& t : renamed) {
    const auto place = std::ranges::lower_bound(mesh.triangles, t);
    const bool is_there = place != mesh.triangles.end() && *place == t;
    mesh.of_given.push_back(is_there ? static_cast<std::uint32_t>(place - mesh.triangles.begin()) : kNone);
  }
  mesh.size = bounds_of(given).size().norm();
  measure(mesh);
  join_neighbors(mesh);
  return mesh;
}

}  // namespace verisim::recover
