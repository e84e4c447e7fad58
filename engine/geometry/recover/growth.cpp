#include "engine/geometry/recover/growth.hpp"

#include <algorithm>
#include <cmath>

#include "engine/geometry/recover/evidence.hpp"
#include "engine/geometry/recover/surface_fit.hpp"

namespace verisim::recover {

namespace {

constexpr int kGrowings = 8;

bool passes_through(const SurfaceValue& s, std::span<const Vector3d> points, double within) {
  return std::ranges::all_of(points, [&](const Vector3d& p) { return std::abs(s.distance(p)) <= within; });
}

}  // namespace

std::vector<std::uint32_t> Growth::grow(const RoundFit& fit, std::uint32_t seed) {
  std::vector<std::uint32_t> found;
  const Piece piece = regions_.piece_of(fit, seed);
  if (!piece.is_regular(seed)) return found;
  ++growing_;
  found.push_back(seed);
  mark_[seed] = growing_;
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (const std::uint32_t t : regions_.mesh.neighbors[found[i]]) {
      if (t == kNone || mark_[t] == growing_ || !regions_.is_free(t)) continue;
      mark_[t] = growing_;
      if (piece.is_regular(t)) found.push_back(t);
    }
  }
  std::ranges::sort(found);
  return found;
}

std::optional<Candidate> Growth::from(const std::vector<std::uint32_t>& facets, Kind kind, bool by_inner,
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
  if (by_inner) {
    std::vector<Vector3d> inner = regions_.points_of(std::move(vertices), true);
    if (inner.size() < fewest_points(kind) || inner.size() == sample.points.size()) return std::nullopt;
    sample.points = std::move(inner);
  }
  const double tolerance = regions_.tolerance;
  std::optional<SurfaceValue> surface = fit(kind, sample, tolerance);
  if (!surface || !passes_through(*surface, sample.points, tolerance)) return std::nullopt;
  Candidate best;
  for (int i = 0; i < kGrowings; ++i) {
    std::vector<std::uint32_t> triangles = grow({*surface, by_inner}, seed);
    if (triangles.size() <= best.triangles.size()) break;
    best = {{*surface, by_inner}, std::move(triangles)};
    surface = refit(*surface, regions_.points_of_triangles(best.triangles, by_inner), tolerance);
    if (!surface) break;
  }
  if (best.triangles.empty()) return std::nullopt;
  const std::vector<Vector3d> points = regions_.points_of_triangles(best.triangles, by_inner);
  if (surface && passes_through(*surface, points, tolerance)) best.fit.surface = *surface;
  if (!passes_through(best.fit.surface, points, regions_.thresholds.snug * tolerance)) return std::nullopt;
  if (!is_evident(best.fit.surface, points, tolerance, regions_.thresholds)) return std::nullopt;
  best.area = regions_.area_of(best.triangles);
  return best;
}

void Growth::add_fans(Candidate& found) {
  const Piece piece = regions_.piece_of(found.fit, found.triangles.front());
  ++growing_;
  for (const std::uint32_t t : found.triangles) mark_[t] = growing_;
  for (std::size_t i = 0; i < found.triangles.size(); ++i) {
    for (const std::uint32_t t : regions_.mesh.neighbors[found.triangles[i]]) {
      if (t == kNone || mark_[t] == growing_ || !regions_.is_free(t)) continue;
      mark_[t] = growing_;
      if (regions_.is_small(regions_.facets.of_triangle[t]) && piece.is_possible(t)) found.triangles.push_back(t);
    }
  }
  std::ranges::sort(found.triangles);
}

}  // namespace verisim::recover
