#include "engine/geometry/recover/facets.hpp"

#include <algorithm>

#include "engine/geometry/recover/flat_regions.hpp"

namespace verisim::recover {

namespace {

void measure(const CanonicalMesh& mesh, Facet& facet) {
  Vector3d normal = Vector3d::Zero(), center = Vector3d::Zero();
  for (const std::uint32_t t : facet.triangles) {
    normal += mesh.areas[t] * mesh.normals[t];
    facet.area += mesh.areas[t];
    facet.vertices.insert(facet.vertices.end(), mesh.triangles[t].begin(), mesh.triangles[t].end());
  }
  std::ranges::sort(facet.vertices);
  facet.vertices.erase(std::unique(facet.vertices.begin(), facet.vertices.end()), facet.vertices.end());
  for (const std::uint32_t v : facet.vertices) center += mesh.vertices[v];
  facet.normal = normal.norm() > 0 ? Vector3d(normal.normalized()) : Vector3d::Zero();
  facet.center = center / static_cast<double>(facet.vertices.size());
}

/// One segment of a facet's border.
struct BorderSegment {
  std::uint32_t facet;
  Vector3d from, to;
};

std::vector<BorderSegment> border_of(const CanonicalMesh& mesh, const Facets& facets, std::uint32_t number) {
  std::vector<BorderSegment> segments;
  for (const std::uint32_t t : facets.all[number].triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t beside = mesh.neighbors[t][i];
      const std::uint32_t facet = beside == kNone ? kNone : facets.of_triangle[beside];
      if (facet != number) segments.push_back({facet, mesh.corner(t, i), mesh.corner(t, (i + 1) % 3)});
    }
  }
  std::ranges::stable_sort(segments, {}, &BorderSegment::facet);
  return segments;
}

std::vector<FacetSide> sides_of(const std::vector<BorderSegment>& segments, const Facets& facets, std::uint32_t number,
                                double cos_smooth) {
  std::vector<FacetSide> sides;
  double longest = 0;
  for (const BorderSegment& segment : segments) {
    const Vector3d way = segment.to - segment.from;
    const double length = way.norm();
    if (sides.empty() || sides.back().facet != segment.facet) {
      const bool smooth =
          segment.facet != kNone && facets.all[number].normal.dot(facets.all[segment.facet].normal) > cos_smooth;
      sides.push_back({segment.facet, 0, Vector3d::Zero(), Vector3d::Zero(), smooth});
      longest = 0;
    }
    FacetSide& side = sides.back();
    side.length += length;
    side.middle += 0.5 * length * (segment.from + segment.to);
    if (length > longest) {
      longest = length;
      side.direction = way / length;
    }
  }
  for (FacetSide& side : sides) {
    if (side.length > 0) side.middle /= side.length;
  }
  return sides;
}

}  // namespace

Facets facets_of(const CanonicalMesh& mesh, double tolerance, double cos_smooth, const RecoverThresholds& thresholds) {
  Facets facets;
  facets.of_triangle.assign(mesh.triangles.size(), kNone);
  for (std::vector<std::uint32_t>& triangles : flat_regions(mesh, tolerance, thresholds)) {
    const auto number = static_cast<std::uint32_t>(facets.all.size());
    std::ranges::sort(triangles);
    for (const std::uint32_t t : triangles) facets.of_triangle[t] = number;
    Facet& facet = facets.all.emplace_back();
    facet.triangles = std::move(triangles);
    measure(mesh, facet);
  }
  for (std::uint32_t i = 0; i < facets.all.size(); ++i)
    facets.all[i].sides = sides_of(border_of(mesh, facets, i), facets, i, cos_smooth);
  return facets;
}

}  // namespace verisim::recover
