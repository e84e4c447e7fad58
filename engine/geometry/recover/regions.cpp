#include "engine/geometry/recover/regions.hpp"

#include <algorithm>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/geometry/recover/surface_fit.hpp"

namespace verisim::recover {

Regions::Regions(const CanonicalMesh& given, double tolerance_m, double round_step, const RecoverThresholds& wanted)
    : mesh(given),
      tolerance(tolerance_m),
      thresholds(wanted),
      cos_smooth(pinned::cos(round_step)),
      cos_step(pinned::cos(thresholds.longer_step * round_step)),
      facets(facets_of(mesh, tolerance, cos_smooth, thresholds)),
      on_sharp_edge_(mesh.vertices.size(), false),
      of_triangle_(mesh.triangles.size(), kNone),
      assigned_in_facet_(facets.all.size(), 0) {
  VERISIM_ASSERT(is_positive(tolerance));
  VERISIM_ASSERT(cos_smooth < 1);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t beside = mesh.neighbors[t][i];
      if (beside != kNone && is_smooth(t, beside)) continue;
      on_sharp_edge_[mesh.triangles[t][i]] = on_sharp_edge_[mesh.triangles[t][(i + 1) % 3]] = true;
    }
  }
}

bool Regions::is_smooth(std::uint32_t t, std::uint32_t beside) const {
  const bool is_sliver = std::min(mesh.heights[t], mesh.heights[beside]) <= thresholds.sliver * tolerance;
  return is_sliver || mesh.normals[t].dot(mesh.normals[beside]) > cos_smooth;
}

double Regions::area_of(const std::vector<std::uint32_t>& triangles) const {
  double area = 0;
  for (const std::uint32_t t : triangles) area += mesh.areas[t];
  return area;
}

InlierTest Regions::inlier_test(const CurvedFit& fit, std::uint32_t seed) const {
  const bool is_hole = fit.surface.gradient(mesh.centers[seed]).dot(mesh.normals[seed]) < 0;
  return {mesh, fit.surface, {tolerance, fit.inner_only ? &on_sharp_edge_ : nullptr, cos_step, is_hole, thresholds}};
}

std::vector<Vector3d> Regions::points_of_triangles(const std::vector<std::uint32_t>& triangles, bool inner_only) const {
  std::vector<std::uint32_t> vertices;
  for (const std::uint32_t t : triangles) {
    vertices.insert(vertices.end(), mesh.triangles[t].begin(), mesh.triangles[t].end());
  }
  return points_of(std::move(vertices), inner_only);
}

std::vector<Vector3d> Regions::points_of(std::vector<std::uint32_t> vertices, bool inner_only) const {
  std::ranges::sort(vertices);
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  std::vector<Vector3d> points;
  points.reserve(vertices.size());
  for (const std::uint32_t v : vertices) {
    if (!inner_only || !on_sharp_edge_[v]) points.push_back(mesh.vertices[v]);
  }
  return points;
}

void Regions::add_region(FoundRegion region) {
  for (const std::uint32_t t : region.triangles) {
    VERISIM_ASSERT(is_free(t));
    of_triangle_[t] = static_cast<std::uint32_t>(all.size());
    ++assigned_in_facet_[facets.of_triangle[t]];
  }
  all.push_back(std::move(region));
}

void Regions::add_curved(const CurvedFit& fit, std::vector<std::uint32_t> triangles) {
  VERISIM_ASSERT(!triangles.empty());
  const std::uint32_t first = triangles.front();
  const bool hole = fit.surface.gradient(mesh.centers[first]).dot(mesh.normals[first]) < 0;
  Surface surface = fit.surface.surface();
  std::visit(
      [&](auto& s) {
        if constexpr (requires { s.hole; }) s.hole = hole;
      },
      surface);
  add_region({std::move(surface), std::move(triangles), fit});
}

void Regions::add_plane(std::uint32_t facet) {
  const std::vector<std::uint32_t>& triangles = facets.all[facet].triangles;
  SurfaceValue plane = plane_through(points_of_triangles(triangles, false));
  if (plane.axis.dot(facets.all[facet].normal) < 0) plane.axis = -plane.axis;
  add_region({plane.surface(), triangles, std::nullopt});
}

void Regions::add_freeform(std::vector<std::uint32_t> triangles) {
  add_region({OtherSurface{}, std::move(triangles), std::nullopt});
}

void Regions::assign(std::uint32_t region, std::uint32_t triangle) {
  VERISIM_ASSERT(region < all.size());
  VERISIM_ASSERT(is_free(triangle));
  of_triangle_[triangle] = region;
  ++assigned_in_facet_[facets.of_triangle[triangle]];
  all[region].triangles.push_back(triangle);
}

void Regions::merge(std::uint32_t region, std::uint32_t into) {
  VERISIM_ASSERT(region != into);
  std::vector<std::uint32_t>& triangles = all[region].triangles;
  for (const std::uint32_t t : triangles) of_triangle_[t] = into;
  all[into].triangles.insert(all[into].triangles.end(), triangles.begin(), triangles.end());
  triangles.clear();
}

void Regions::release(std::uint32_t region) {
  for (const std::uint32_t t : all[region].triangles) {
    of_triangle_[t] = kNone;
    --assigned_in_facet_[facets.of_triangle[t]];
  }
  all[region].triangles.clear();
}

}  // namespace verisim::recover
