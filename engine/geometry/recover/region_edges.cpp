#include "engine/geometry/recover/region_edges.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/base/pinned_math.hpp"
#include "engine/geometry/recover/curve_fit.hpp"

namespace verisim::recover {

namespace {

/// A side of the mesh between two regions; the second is kNone where the mesh is open.
struct EdgePiece {
  std::array<std::uint32_t, 2> vertices;
  std::array<std::uint32_t, 2> regions;
};

std::vector<EdgePiece> pieces_of(const CanonicalMesh& mesh, const std::vector<Region>& regions) {
  std::vector<std::uint32_t> region_of(mesh.triangles.size(), kNone);
  for (std::uint32_t r = 0; r < regions.size(); ++r) {
    for (const std::uint32_t t : regions[r].triangles) region_of[t] = r;
  }
  std::vector<EdgePiece> pieces;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t beside = mesh.neighbors[t][i];
      const std::uint32_t other = beside == kNone ? kNone : region_of[beside];
      if (other == region_of[t] || (beside != kNone && beside < t)) continue;
      const auto [from, to] = std::minmax(mesh.triangles[t][i], mesh.triangles[t][(i + 1) % 3]);
      const auto [low, high] = std::minmax(region_of[t], other);
      pieces.push_back({{from, to}, {low, high}});
    }
  }
  std::ranges::sort(pieces, {}, &EdgePiece::vertices);
  return pieces;
}

/// Pieces at each vertex.
class Chains {
 public:
  explicit Chains(const std::vector<EdgePiece>& pieces) : pieces_(pieces), used_(pieces.size(), false) {
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      for (const std::uint32_t v : pieces[i].vertices) at_[v].push_back(i);
    }
  }

  /// Calls visit(vertices, regions) for each chain: those with ends first, then rings, whose last vertex is the first.
  template <typename Visit>
  void for_each(Visit visit) {
    for (const bool rings : {false, true}) {
      for (const auto& [vertex, pieces] : at_) {
        if (!rings && !is_end(vertex)) continue;
        for (const std::size_t piece : pieces) {
          if (!used_[piece]) visit(follow(vertex, piece), pieces_[piece].regions);
        }
      }
    }
  }

 private:
  [[nodiscard]] bool is_end(std::uint32_t vertex) const {
    const std::vector<std::size_t>& pieces = at_.at(vertex);
    return pieces.size() != 2 || pieces_[pieces[0]].regions != pieces_[pieces[1]].regions;
  }

  std::vector<std::uint32_t> follow(std::uint32_t from, std::size_t piece) {
    std::vector<std::uint32_t> chain = {from};
    while (!used_[piece]) {
      used_[piece] = true;
      const auto& [a, b] = pieces_[piece].vertices;
      const std::uint32_t next = chain.back() == a ? b : a;
      chain.push_back(next);
      if (is_end(next)) break;
      const std::vector<std::size_t>& here = at_.at(next);
      piece = here[0] == piece ? here[1] : here[0];
    }
    return chain;
  }

  const std::vector<EdgePiece>& pieces_;
  std::vector<bool> used_;
  std::map<std::uint32_t, std::vector<std::size_t>> at_;
};

}  // namespace

std::vector<Edge> edges_between(const CanonicalMesh& mesh, const std::vector<Region>& regions, double tolerance) {
  const std::vector<EdgePiece> pieces = pieces_of(mesh, regions);
  std::vector<Edge> edges;
  Chains(pieces).for_each([&](const std::vector<std::uint32_t>& chain, const std::array<std::uint32_t, 2>& between) {
    Edge edge;
    for (const std::uint32_t v : chain) edge.polyline.push_back(mesh.vertices[v]);
    std::vector<const Surface*> beside;
    for (const std::uint32_t r : between) {
      if (r == kNone) continue;
      edge.faces.push_back(r);
      beside.push_back(&regions[r].surface);
    }
    set_curve(edge, beside, tolerance);
    edges.push_back(std::move(edge));
  });
  return edges;
}

}  // namespace verisim::recover
