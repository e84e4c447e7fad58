#include "engine/geometry/recover/region_edges.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/base/pinned_math.hpp"
#include "engine/geometry/recover/curve_fit.hpp"

namespace verisim::recover {

namespace {

/// A side of the mesh between two regions; the second region is kNone where the mesh is open.
struct BoundarySegment {
  std::array<std::uint32_t, 2> vertices;
  std::array<std::uint32_t, 2> regions;
};

std::vector<BoundarySegment> boundary_of(const CanonicalMesh& mesh, const std::vector<Region>& regions) {
  std::vector<std::uint32_t> region_of(mesh.triangles.size(), kNone);
  for (std::uint32_t r = 0; r < regions.size(); ++r) {
    for (const std::uint32_t t : regions[r].triangles) region_of[t] = r;
  }
  std::vector<BoundarySegment> segments;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t beside = mesh.neighbors[t][i];
      const std::uint32_t other = beside == kNone ? kNone : region_of[beside];
      if (other == region_of[t] || (beside != kNone && beside < t)) continue;
      const auto [from, to] = std::minmax(mesh.triangles[t][i], mesh.triangles[t][(i + 1) % 3]);
      const auto [low, high] = std::minmax(region_of[t], other);
      segments.push_back({{from, to}, {low, high}});
    }
  }
  std::ranges::sort(segments, {}, &BoundarySegment::vertices);
  return segments;
}

/// Joins boundary segments into chains.
class BoundaryChains {
 public:
  explicit BoundaryChains(const std::vector<BoundarySegment>& segments)
      : segments_(segments), used_(segments.size(), false) {
    for (std::size_t i = 0; i < segments.size(); ++i) {
      for (const std::uint32_t v : segments[i].vertices) at_[v].push_back(i);
    }
  }

  /// Calls visit(vertices, regions) for each chain: those with ends first, then loops, whose last vertex is the first.
  template <typename Visit>
  void for_each(Visit visit) {
    for (const bool loops : {false, true}) {
      for (const auto& [vertex, segments] : at_) {
        if (!loops && !is_end(vertex)) continue;
        for (const std::size_t segment : segments) {
          if (!used_[segment]) visit(follow(vertex, segment), segments_[segment].regions);
        }
      }
    }
  }

 private:
  [[nodiscard]] bool is_end(std::uint32_t vertex) const {
    const std::vector<std::size_t>& segments = at_.at(vertex);
    return segments.size() != 2 || segments_[segments[0]].regions != segments_[segments[1]].regions;
  }

  std::vector<std::uint32_t> follow(std::uint32_t from, std::size_t segment) {
    std::vector<std::uint32_t> chain = {from};
    while (!used_[segment]) {
      used_[segment] = true;
      const auto& [a, b] = segments_[segment].vertices;
      const std::uint32_t next = chain.back() == a ? b : a;
      chain.push_back(next);
      if (is_end(next)) break;
      const std::vector<std::size_t>& here = at_.at(next);
      segment = here[0] == segment ? here[1] : here[0];
    }
    return chain;
  }

  const std::vector<BoundarySegment>& segments_;
  std::vector<bool> used_;
  std::map<std::uint32_t, std::vector<std::size_t>> at_;
};

}  // namespace

std::vector<Edge> edges_between(const CanonicalMesh& mesh, const std::vector<Region>& regions, double tolerance,
                                const RecoverThresholds& thresholds) {
  const std::vector<BoundarySegment> segments = boundary_of(mesh, regions);
  std::vector<Edge> edges;
  BoundaryChains(segments).for_each(
      [&](const std::vector<std::uint32_t>& chain, const std::array<std::uint32_t, 2>& between) {
        Edge edge;
        for (const std::uint32_t v : chain) edge.polyline.push_back(mesh.vertices[v]);
        std::vector<const Surface*> beside;
        for (const std::uint32_t r : between) {
          if (r == kNone) continue;
          edge.faces.push_back(r);
          beside.push_back(&regions[r].surface);
        }
        set_curve(edge, beside, tolerance, thresholds);
        edges.push_back(std::move(edge));
      });
  return edges;
}

}  // namespace verisim::recover
