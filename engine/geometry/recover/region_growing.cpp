#include "engine/geometry/recover/region_growing.hpp"

#include <algorithm>
#include <cmath>

#include "engine/geometry/recover/fit_ambiguity.hpp"
#include "engine/geometry/recover/surface_fit.hpp"

namespace verisim::recover {

namespace {

constexpr int kPassesMax = 8;  // a bound of the work: growing ends when a pass adds nothing, usually the third

bool passes_through(const SurfaceValue& s, std::span<const Vector3d> points, double within) {
  return std::ranges::all_of(points, [&](const Vector3d& p) { return std::abs(s.distance(p)) <= within; });
}

}  // namespace

std::vector<std::uint32_t> RegionGrowing::grow(const CurvedFit& fit, std::uint32_t seed) {
  std::vector<std::uint32_t> found;
  const InlierTest inliers = regions_.inlier_test(fit, seed);
  if (!inliers.is_inlier(seed)) return found;
  ++pass_;
  found.push_back(seed);
  last_pass_[seed] = pass_;
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (const std::uint32_t t : regions_.mesh.neighbors[found[i]]) {
      if (t == kNone || last_pass_[t] == pass_ || !regions_.is_free(t)) continue;
      last_pass_[t] = pass_;
      if (inliers.is_inlier(t)) found.push_back(t);
    }
  }
  std::ranges::sort(found);
  return found;
}

std::optional<Candidate> RegionGrowing::grow_from(const std::vector<std::uint32_t>& facets, Kind kind, bool inner_only,
                                                  std::uint32_t seed) {
  Sample sample;
  std::vector<std::uint32_t> vertices;
  for (const std::uint32_t f : facets) {
    const Facet& facet = regions_.facets.all[f];
    sample.centers.push_back(facet.center);
    sample.normals.push_back(facet.normal);
    vertices.insert(vertices.end(), facet.vertices.begin(), facet.vertices.end());
  }
  sample.points = regions_.points_of(vertices, false);
  if (inner_only) {
    std::vector<Vector3d> inner = regions_.points_of(std::move(vertices), true);
    if (inner.size() < regions_.thresholds.points_min[static_cast<std::size_t>(kind)] ||
        inner.size() == sample.points.size())
      return std::nullopt;
    sample.points = std::move(inner);
  }
  const double tolerance = regions_.tolerance;
  std::optional<SurfaceValue> surface = fit(kind, sample, tolerance, regions_.thresholds);
  if (!surface || !passes_through(*surface, sample.points, tolerance)) return std::nullopt;
  Candidate best;
  for (int i = 0; i < kPassesMax; ++i) {
    std::vector<std::uint32_t> triangles = grow({*surface, inner_only}, seed);
    if (triangles.size() <= best.triangles.size()) break;
    best = {{*surface, inner_only}, std::move(triangles)};
    surface = refit(*surface, regions_.points_of_triangles(best.triangles, inner_only), tolerance, regions_.thresholds);
    if (!surface) break;
  }
  if (best.triangles.empty()) return std::nullopt;
  const std::vector<Vector3d> points = regions_.points_of_triangles(best.triangles, inner_only);
  if (surface && passes_through(*surface, points, tolerance)) best.fit.surface = *surface;
  if (!passes_through(best.fit.surface, points, regions_.thresholds.tight_fit * tolerance)) return std::nullopt;
  if (!is_unambiguous(best.fit.surface, points, tolerance, regions_.thresholds)) return std::nullopt;
  best.area = regions_.area_of(best.triangles);
  return best;
}

void RegionGrowing::add_fans(Candidate& found) {
  const InlierTest inliers = regions_.inlier_test(found.fit, found.triangles.front());
  ++pass_;
  for (const std::uint32_t t : found.triangles) last_pass_[t] = pass_;
  for (std::size_t i = 0; i < found.triangles.size(); ++i) {
    for (const std::uint32_t t : regions_.mesh.neighbors[found.triangles[i]]) {
      if (t == kNone || last_pass_[t] == pass_ || !regions_.is_free(t)) continue;
      last_pass_[t] = pass_;
      if (regions_.is_small(regions_.facets.of_triangle[t]) && inliers.is_loose_inlier(t)) found.triangles.push_back(t);
    }
  }
  std::ranges::sort(found.triangles);
}

}  // namespace verisim::recover
