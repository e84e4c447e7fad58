#include "engine/geometry/mesh.hpp"

#include <algorithm>
#include <unordered_map>

#include "engine/base/error.hpp"
#include "engine/geometry/mesh_edges.hpp"
#include "engine/geometry/self_intersection.hpp"

namespace verisim {
namespace {

struct Corners {
  Vector3d a, b, c;
};

Corners corners_of(const TriangleMesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
  return {mesh.vertices[triangle[0]], mesh.vertices[triangle[1]], mesh.vertices[triangle[2]]};
}

void count_edges(const TriangleMesh& mesh, std::span<const Side> sides, MeshReport& report) {
  bool located = false;
  for_each_edge(sides, [&](std::span<const Side> edge) {
    if (edge.size() == 1) ++report.open_edges;
    if (edge.size() > 2) ++report.nonmanifold_edges;
    if (edge.size() == 2 && edge[0].forward == edge[1].forward) ++report.misoriented_edges;
    if (edge.size() != 2 && !located) {
      report.where = 0.5 * (mesh.vertices[edge[0].low] + mesh.vertices[edge[0].high]);
      located = true;
    }
  });
}

std::size_t count_duplicates(const TriangleMesh& mesh) {
  std::vector<std::array<std::uint32_t, 3>> sorted = mesh.triangles;
  for (auto& triangle : sorted) std::sort(triangle.begin(), triangle.end());
  std::sort(sorted.begin(), sorted.end());
  return static_cast<std::size_t>(sorted.end() - std::unique(sorted.begin(), sorted.end()));
}

}  // namespace

Bounds bounds_of(const TriangleMesh& mesh) {
  VERISIM_ASSERT(is_whole(mesh));
  Bounds bounds;
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) bounds.include(mesh.vertices[corner]);
  }
  return bounds;
}

MassProperties mass_properties_of(const TriangleMesh& mesh) {
  MassProperties mass;
  if (mesh.triangles.empty()) return mass;
  // Tetrahedra from the box's centre: with the origin of a far-away part as their tip the volumes would cancel.
  const Vector3d tip = bounds_of(mesh).center();
  double volume = 0;
  Vector3d first_moment = Vector3d::Zero();
  Matrix3d second_moment = Matrix3d::Zero();
  for (const auto& triangle : mesh.triangles) {
    auto [a, b, c] = corners_of(mesh, triangle);
    a -= tip;
    b -= tip;
    c -= tip;
    const double six_volumes = a.dot(b.cross(c));
    const Vector3d sum = a + b + c;
    volume += six_volumes / 6;
    first_moment += six_volumes / 24 * sum;
    second_moment +=
        six_volumes / 120 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
  }
  mass.volume = volume;
  if (volume == 0) {
    mass.centroid = tip;
    return mass;
  }
  const Vector3d offset = first_moment / volume;
  mass.centroid = tip + offset;
  const Matrix3d central = second_moment - volume * offset * offset.transpose();
  mass.inertia = central.trace() * Matrix3d::Identity() - central;
  return mass;
}

double area_of(const TriangleMesh& mesh) {
  VERISIM_ASSERT(is_whole(mesh));
  double area = 0;
  for (const auto& triangle : mesh.triangles) {
    const auto [a, b, c] = corners_of(mesh, triangle);
    area += 0.5 * (b - a).cross(c - a).norm();
  }
  return area;
}

MeshReport examine(const TriangleMesh& mesh, bool thorough) {
  VERISIM_ASSERT(is_whole(mesh));
  MeshReport report;
  for (const Vector3d& p : mesh.vertices) report.not_finite = report.not_finite || !p.allFinite();
  if (report.not_finite) return report;
  for (const auto& triangle : mesh.triangles) report.degenerate_triangles += is_degenerate(mesh, triangle) ? 1 : 0;
  report.duplicate_triangles = count_duplicates(mesh);
  const std::vector<Side> sides = sorted_sides(mesh);
  count_edges(mesh, sides, report);
  report.components = components_of(mesh, sides, true).count;
  report.inside_out = report.open_edges == 0 && report.nonmanifold_edges == 0 && report.misoriented_edges == 0 &&
                      mass_properties_of(mesh).volume < 0;
  if (thorough) {
    const SelfIntersections crossings = find_self_intersections(mesh);
    report.self_intersections = crossings.pairs;
    if (crossings.pairs > 0 && report.open_edges == 0 && report.nonmanifold_edges == 0) report.where = crossings.where;
  }
  return report;
}

}  // namespace verisim
