#include "engine/geometry/recover/region_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>

#include "engine/base/pinned_math.hpp"
#include "engine/geometry/recover/evidence.hpp"
#include "engine/geometry/recover/facets.hpp"
#include "engine/geometry/recover/flat_regions.hpp"
#include "engine/geometry/recover/piece.hpp"
#include "engine/geometry/recover/surface_fit.hpp"

namespace verisim::recover {

namespace {

constexpr Kind kRoundKinds[] = {Kind::cylinder, Kind::cone, Kind::sphere, Kind::torus};
constexpr double kLargerByFar = 1.001;  // in area, for a kind that is less simple
constexpr int kGrowings = 8;
constexpr std::array<std::size_t, 4> kAround = {2, 3, 6, 12};  // steps
constexpr std::size_t kAgain = 3;                              // steps from what was taken
constexpr std::size_t kBarren = 2;                             // steps from where nothing fits
constexpr int kSteps = 4;                                      // facets of a row to each side
constexpr double kNarrower = 0.25;  // of a plane's width: a neighbour that curves away from it
constexpr std::size_t kFewFacets = 4;
constexpr double kLongerStep = 1.1;  // of a chord, against the mean of two
constexpr double kSnug = 0.5;
constexpr std::size_t kFan = 2;  // triangles of a facet
constexpr double kMostlySharp = 0.6;  // of a border

struct Candidate {
  SurfaceValue surface;
  bool by_inner = false;  // fitted to vertices off sharp edges
  std::vector<std::uint32_t> triangles;
  double area = 0;
};

/// Is a vertex on a sharp or open edge?
std::vector<bool> rim_of(const CanonicalMesh& mesh, double tolerance, double cos_smooth) {
  std::vector<bool> is_rim(mesh.vertices.size(), false);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t n = mesh.neighbors[t][i];
      if (n != kNone) {
        const bool sliver = std::min(mesh.heights[t], mesh.heights[n]) <= kSliver * tolerance;
        if (sliver || mesh.normals[t].dot(mesh.normals[n]) > cos_smooth) continue;
      }
      is_rim[mesh.triangles[t][i]] = is_rim[mesh.triangles[t][(i + 1) % 3]] = true;
    }
  }
  return is_rim;
}

class Search {
 public:
  Search(const CanonicalMesh& mesh, double tolerance, double round_step)
      : mesh_(mesh),
        tolerance_(tolerance),
        cos_smooth_(pinned::cos(round_step)),
        cos_step_(pinned::cos(kLongerStep * round_step)),
        facets_(facets_of(mesh, tolerance, cos_smooth_)),
        is_rim_(rim_of(mesh, tolerance, cos_smooth_)),
        region_of_(mesh.triangles.size(), kNone),
        taken_(mesh.triangles.size(), false),
        taken_of_facet_(facets_.all.size(), 0),
        untried_(facets_.all.size(), true),
        met_(facets_.all.size(), false),
        mark_(mesh.triangles.size(), 0) {}

  std::vector<Region> run() {
    while (take_round() || take_small_planes()) {
    }
    give_to_larger();
    take_rest();
    return std::move(regions_);
  }

 private:
  /// Round surfaces, and planes of many triangles, as long as there are any.
  bool take_round() {
    bool found = false;
    for (std::uint32_t facet = 0; facet < facets_.all.size(); ++facet) {
      if (untried_[facet] && is_free(facet)) found |= try_from(facet);
    }
    return found;
  }

  /// A facet of a triangle or two that borders as a plane may still have belonged to a round surface beside it.
  bool take_small_planes() {
    bool found = false;
    for (std::uint32_t facet = 0; facet < facets_.all.size(); ++facet) {
      if (!is_free(facet) || !borders_as_a_plane(facet)) continue;
      take_plane(facet);
      try_again_beside(regions_.back().triangles);
      found = true;
    }
    return found;
  }

  [[nodiscard]] bool is_free(std::uint32_t facet) const { return taken_of_facet_[facet] == 0; }

  /// Everything that is free and smoothly joined to a facet, up to `most` steps away. Ascending.
  std::vector<std::uint32_t> around(std::uint32_t facet, std::size_t most) {
    std::vector<std::uint32_t> found = {facet};
    met_[facet] = true;
    std::size_t begin = 0;
    for (std::size_t step = 0; step < most && begin < found.size(); ++step) {
      const std::size_t end = found.size();
      for (; begin < end; ++begin) {
        for (const FacetSide& side : facets_.all[found[begin]].sides) {
          if (!side.smooth || met_[side.facet] || !is_free(side.facet)) continue;
          met_[side.facet] = true;
          found.push_back(side.facet);
        }
      }
    }
    for (const std::uint32_t f : found) met_[f] = false;
    std::ranges::sort(found);
    return found;
  }

  /// A row of facets: on through the side that is opposite to the one through which a facet was entered.
  void walk(std::uint32_t facet, const FacetSide* through, std::vector<std::uint32_t>& row) const {
    for (int step = 0; step < kSteps && through != nullptr; ++step) {
      const std::uint32_t next = through->facet;
      if (!through->smooth || !is_free(next) || std::ranges::find(row, next) != row.end()) return;
      row.push_back(next);
      const FacetSide* onward = nullptr;
      double best = 0;
      for (const FacetSide& side : facets_.all[next].sides) {
        if (side.facet == facet || side.facet == kNone) continue;
        const Vector3d way = side.middle - through->middle;
        const double along = std::abs(side.direction.dot(through->direction)) *
                             (way - way.dot(through->direction) * through->direction).norm();
        if (along <= best) continue;
        best = along;
        onward = &side;
      }
      facet = next;
      through = onward;
    }
  }

  /// The rows through a facet: across its longest side, and across the one that is most at right angles to that.
  [[nodiscard]] std::vector<std::vector<std::uint32_t>> rows(std::uint32_t facet) const {
    const std::vector<FacetSide>& sides = facets_.all[facet].sides;
    const FacetSide* longest = nullptr;
    for (const FacetSide& side : sides) {
      if (side.smooth && (longest == nullptr || side.length > longest->length)) longest = &side;
    }
    std::vector<std::vector<std::uint32_t>> result;
    if (longest == nullptr) return result;
    for (const bool across : {false, true}) {
      std::vector<std::uint32_t> row = {facet};
      for (const FacetSide& side : sides) {
        const bool is_parallel = std::abs(side.direction.dot(longest->direction)) > 0.7;
        if (side.smooth && is_parallel != across) walk(facet, &side, row);
      }
      std::ranges::sort(row);
      row.erase(std::unique(row.begin(), row.end()), row.end());
      result.push_back(std::move(row));
    }
    std::vector<std::uint32_t> both;
    std::ranges::set_union(result[0], result[1], std::back_inserter(both));
    result.push_back(std::move(both));
    return result;
  }

  struct Around {
    Sample sample;
    std::vector<Vector3d> inner;  ///< its points that are on no sharp edge
  };

  [[nodiscard]] Around sample_of(const std::vector<std::uint32_t>& facets) const {
    Around around;
    Sample& sample = around.sample;
    std::vector<std::uint32_t> vertices;
    for (const std::uint32_t f : facets) {
      const Facet& facet = facets_.all[f];
      sample.centers.push_back(facet.center);
      sample.normals.push_back(facet.normal);
      vertices.insert(vertices.end(), facet.vertices.begin(), facet.vertices.end());
    }
    sample.points = points_of(vertices, false);
    around.inner = points_of(std::move(vertices), true);
    return around;
  }

  [[nodiscard]] std::vector<Vector3d> points_of(std::vector<std::uint32_t> vertices, bool inner) const {
    std::ranges::sort(vertices);
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    std::vector<Vector3d> points;
    points.reserve(vertices.size());
    for (const std::uint32_t v : vertices) {
      if (!inner || !is_rim_[v]) points.push_back(mesh_.vertices[v]);
    }
    return points;
  }

  [[nodiscard]] std::vector<Vector3d> points_of_triangles(const std::vector<std::uint32_t>& triangles, bool inner) const {
    std::vector<std::uint32_t> vertices;
    for (const std::uint32_t t : triangles) {
      vertices.insert(vertices.end(), mesh_.triangles[t].begin(), mesh_.triangles[t].end());
    }
    return points_of(std::move(vertices), inner);
  }

  [[nodiscard]] bool passes_through(const SurfaceValue& s, std::span<const Vector3d> points, double within) const {
    return std::ranges::all_of(points, [&](const Vector3d& p) { return std::abs(s.distance(p)) <= within; });
  }

  /// Free triangles, joined to the seed, that stand for the surface. Ascending.
  std::vector<std::uint32_t> grow(const SurfaceValue& s, bool by_inner, std::uint32_t seed) {
    std::vector<std::uint32_t> found;
    const Piece piece = piece_of(s, by_inner, seed);
    if (!piece.is_regular(seed)) return found;
    ++growing_;
    found.push_back(seed);
    mark_[seed] = growing_;
    for (std::size_t i = 0; i < found.size(); ++i) {
      for (const std::uint32_t t : mesh_.neighbors[found[i]]) {
        if (t == kNone || mark_[t] == growing_ || taken_[t]) continue;
        mark_[t] = growing_;
        if (piece.is_regular(t)) found.push_back(t);
      }
    }
    std::ranges::sort(found);
    return found;
  }

  /// The surface that passes through a sample, grown from the seed. Where a drawn surface ends at a sharp edge, its
  /// vertices are off by as much as the drawing's tolerance: with by_inner those are not asked.
  std::optional<Candidate> candidate(Kind kind, const Sample& sample, bool by_inner, std::uint32_t seed) {
    std::optional<SurfaceValue> surface = fit(kind, sample, tolerance_);
    if (!surface || !passes_through(*surface, sample.points, tolerance_)) return std::nullopt;
    Candidate best;
    for (int i = 0; i < kGrowings; ++i) {
      std::vector<std::uint32_t> triangles = grow(*surface, by_inner, seed);
      if (triangles.size() <= best.triangles.size()) break;
      best = {*surface, by_inner, std::move(triangles)};
      surface = refit(*surface, points_of_triangles(best.triangles, by_inner), tolerance_);
      if (!surface) break;
    }
    if (best.triangles.empty()) return std::nullopt;
    const std::vector<Vector3d> points = points_of_triangles(best.triangles, by_inner);
    if (surface && passes_through(*surface, points, tolerance_)) best.surface = *surface;
    if (!passes_through(best.surface, points, kSnug * tolerance_)) return std::nullopt;
    if (!is_evident(best.surface, points, tolerance_)) return std::nullopt;
    for (const std::uint32_t t : best.triangles) best.area += mesh_.areas[t];
    return best;
  }

  /// The largest triangle of a facet.
  [[nodiscard]] std::uint32_t seed_of(std::uint32_t facet) const {
    return *std::ranges::max_element(facets_.all[facet].triangles, {}, [&](std::uint32_t t) { return mesh_.areas[t]; });
  }

  bool try_from(std::uint32_t facet) {
    untried_[facet] = false;
    std::vector<std::vector<std::uint32_t>> samples = rows(facet);
    for (const std::size_t steps : kAround) {
      std::vector<std::uint32_t> facets = around(facet, steps);
      const bool is_new = std::ranges::find(samples, facets) == samples.end();
      if (is_new) samples.push_back(std::move(facets));
    }
    std::optional<Candidate> best;
    for (const Kind kind : kRoundKinds) {
      for (const std::vector<std::uint32_t>& facets : samples) {
        if (facets.size() < 3) continue;
        const auto consider = [&](const Sample& sample, bool by_inner) {
          std::optional<Candidate> next = candidate(kind, sample, by_inner, seed_of(facet));
          if (next && (!best || next->area > kLargerByFar * best->area)) best = std::move(next);
        };
        auto [sample, inner] = sample_of(facets);
        consider(sample, false);
        if (kind != Kind::torus || inner.size() == sample.points.size() || inner.size() < fewest_points(kind)) continue;
        sample.points = std::move(inner);
        consider(sample, true);
      }
    }
    if (best) {
      add_fans(*best);
      take(*best);
    }
    else if (facets_.all[facet].triangles.size() > kFan && borders_as_a_plane(facet))
      take_plane(facet);
    else
      return pass_by(facet);
    try_again_beside(regions_.back().triangles);
    return true;
  }

  /// What is not regular beside a surface found, but can be a piece of it and is no face by itself.
  void add_fans(Candidate& found) {
    const Piece piece = piece_of(found.surface, found.by_inner, found.triangles.front());
    ++growing_;
    for (const std::uint32_t t : found.triangles) mark_[t] = growing_;
    for (std::size_t i = 0; i < found.triangles.size(); ++i) {
      for (const std::uint32_t t : mesh_.neighbors[found.triangles[i]]) {
        if (t == kNone || mark_[t] == growing_ || taken_[t]) continue;
        mark_[t] = growing_;
        if (is_fan(t) && piece.is_possible(t)) found.triangles.push_back(t);
      }
    }
    std::ranges::sort(found.triangles);
  }

  [[nodiscard]] bool is_fan(std::uint32_t t) const {
    return facets_.all[facets_.of_triangle[t]].triangles.size() <= kFan;
  }

  [[nodiscard]] Piece piece_of(const SurfaceValue& s, bool by_inner, std::uint32_t seed) const {
    const bool inside_out = s.gradient(mesh_.centers[seed]).dot(mesh_.normals[seed]) < 0;
    return {mesh_, s, {tolerance_, by_inner ? &is_rim_ : nullptr, cos_step_, inside_out}};
  }

  /// From beside a place where nothing fits little will.
  bool pass_by(std::uint32_t facet) {
    for (const std::uint32_t near : around(facet, kBarren)) untried_[near] = false;
    return false;
  }

  /// What a smooth neighbour measures across the common side.
  [[nodiscard]] double width(std::uint32_t facet, const FacetSide& side) const {
    return facets_.all[facet].area / side.length;
  }

  /// A piece of a round surface has neighbours about as wide as itself; a plane that passes into one has narrow ones.
  [[nodiscard]] bool borders_as_a_plane(std::uint32_t facet) const {
    return std::ranges::all_of(facets_.all[facet].sides, [&](const FacetSide& side) {
      return !side.smooth || width(side.facet, side) < kNarrower * width(facet, side);
    });
  }

  [[nodiscard]] bool is_mostly_sharp(std::uint32_t facet) const {
    double sharp = 0, all = 0;
    for (const FacetSide& side : facets_.all[facet].sides) {
      all += side.length;
      if (!side.smooth) sharp += side.length;
    }
    return sharp > kMostlySharp * all;
  }

  /// Planes that meet at small angles are few; pieces of a round or free surface are many, or border on one.
  [[nodiscard]] bool are_planes(const std::vector<std::uint32_t>& joined) const {
    return joined.size() <= kFewFacets && std::ranges::all_of(joined, [&](std::uint32_t facet) {
             return std::ranges::all_of(facets_.all[facet].sides,
                                        [&](const FacetSide& side) { return !side.smooth || is_free(side.facet); });
           });
  }

  void take(const Candidate& best) {
    const std::uint32_t first = best.triangles.front();
    const bool hole = best.surface.gradient(mesh_.centers[first]).dot(mesh_.normals[first]) < 0;
    Surface surface = best.surface.surface();
    std::visit(
        [&](auto& s) {
          if constexpr (requires { s.hole; }) s.hole = hole;
        },
        surface);
    take(std::move(surface), best.triangles);
    values_.back() = {best.surface, best.by_inner};
  }

  void take(Surface surface, std::vector<std::uint32_t> triangles) {
    for (const std::uint32_t t : triangles) {
      taken_[t] = true;
      region_of_[t] = static_cast<std::uint32_t>(regions_.size());
      ++taken_of_facet_[facets_.of_triangle[t]];
    }
    regions_.push_back({std::move(surface), std::move(triangles)});
    values_.emplace_back();
  }

  /// Facets near what was taken last have other surroundings now.
  void try_again_beside(const std::vector<std::uint32_t>& triangles) {
    std::vector<std::uint32_t> beside;
    for (const std::uint32_t t : triangles) {
      for (const std::uint32_t n : mesh_.neighbors[t]) {
        if (n != kNone && is_free(facets_.of_triangle[n])) beside.push_back(facets_.of_triangle[n]);
      }
    }
    std::ranges::sort(beside);
    beside.erase(std::unique(beside.begin(), beside.end()), beside.end());
    for (const std::uint32_t facet : beside) {
      for (const std::uint32_t near : around(facet, kAgain)) untried_[near] = true;
    }
  }

  void take_plane(std::uint32_t facet) {
    const std::vector<std::uint32_t>& triangles = facets_.all[facet].triangles;
    SurfaceValue plane = plane_through(points_of_triangles(triangles, false));
    if (plane.axis.dot(facets_.all[facet].normal) < 0) plane.axis = -plane.axis;
    take(plane.surface(), triangles);
  }

  /// Planes that meet at small angles; then what fits nothing, as far as it is smooth.
  void take_rest() {
    std::vector<bool> seen(facets_.all.size(), false);
    for (std::uint32_t facet = 0; facet < facets_.all.size(); ++facet) {
      if (seen[facet] || !is_free(facet)) continue;
      const std::vector<std::uint32_t> joined = around(facet, facets_.all.size());
      for (const std::uint32_t f : joined) seen[f] = true;
      const bool planes = are_planes(joined);
      for (const std::uint32_t f : joined) {
        if (planes || is_mostly_sharp(f)) take_plane(f);
      }
    }
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (!taken_[t]) take(OtherSurface{}, smooth_rest(t));
    }
  }

  std::vector<std::uint32_t> smooth_rest(std::uint32_t seed) {
    ++growing_;
    std::vector<std::uint32_t> found = {seed};
    mark_[seed] = growing_;
    for (std::size_t i = 0; i < found.size(); ++i) {
      for (const std::uint32_t t : mesh_.neighbors[found[i]]) {
        if (t == kNone || mark_[t] == growing_ || taken_[t]) continue;
        const bool sliver = std::min(mesh_.heights[t], mesh_.heights[found[i]]) <= kSliver * tolerance_;
        if (!sliver && mesh_.normals[t].dot(mesh_.normals[found[i]]) <= cos_smooth_) continue;
        mark_[t] = growing_;
        found.push_back(t);
      }
    }
    std::ranges::sort(found);
    return found;
  }

  /// A strip of a tube can pass for a cylinder before the tube is found: what was taken and can be a piece of a larger
  /// surface beside it is given to that, the larger before the smaller.
  void give_to_larger() {
    std::vector<double> areas;
    for (const Region& region : regions_) {
      areas.push_back(0);
      for (const std::uint32_t t : region.triangles) areas.back() += mesh_.areas[t];
    }
    std::vector<std::uint32_t> order(regions_.size()), asked_by(regions_.size(), kNone);
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::stable_sort(order, std::greater<>{}, [&](std::uint32_t r) { return areas[r]; });
    for (const std::uint32_t larger : order) {
      if (values_[larger] && !regions_[larger].triangles.empty()) give_to(larger, areas, asked_by);
    }
    std::erase_if(regions_, [](const Region& region) { return region.triangles.empty(); });
  }

  void give_to(std::uint32_t larger, const std::vector<double>& areas, std::vector<std::uint32_t>& asked_by) {
    std::vector<std::uint32_t>& triangles = regions_[larger].triangles;
    const Piece piece = piece_of(values_[larger]->first, values_[larger]->second, triangles.front());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      for (const std::uint32_t t : mesh_.neighbors[triangles[i]]) {
        if (t == kNone || region_of_[t] == larger) continue;
        if (!taken_[t]) {
          if (!is_fan(t) || !piece.is_possible(t)) continue;
          taken_[t] = true;
          ++taken_of_facet_[facets_.of_triangle[t]];
          region_of_[t] = larger;
          triangles.push_back(t);
          continue;
        }
        const std::uint32_t other = region_of_[t];
        if (asked_by[other] == larger || areas[other] > areas[larger]) continue;
        asked_by[other] = larger;
        std::vector<std::uint32_t>& theirs = regions_[other].triangles;
        const bool is_flat = std::holds_alternative<Plane>(regions_[other].surface);
        const bool fits = std::ranges::all_of(
            theirs, [&](std::uint32_t n) { return (!is_flat || is_fan(n)) && piece.is_possible(n); });
        if (!fits) continue;
        for (const std::uint32_t n : theirs) region_of_[n] = larger;
        triangles.insert(triangles.end(), theirs.begin(), theirs.end());
        theirs.clear();
      }
    }
    std::ranges::sort(triangles);
  }

  const CanonicalMesh& mesh_;
  double tolerance_;
  double cos_smooth_, cos_step_;
  Facets facets_;
  std::vector<bool> is_rim_;  // vertices
  std::vector<Region> regions_;
  std::vector<std::optional<std::pair<SurfaceValue, bool>>> values_;  // of regions, where round
  std::vector<std::uint32_t> region_of_;             // triangles
  std::vector<bool> taken_;                    // triangles
  std::vector<std::uint32_t> taken_of_facet_;  // how many of its triangles
  std::vector<bool> untried_;                  // facets whose surroundings have changed since they were tried
  std::vector<bool> met_;                      // facets, while around() looks
  std::vector<std::uint32_t> mark_;
  std::uint32_t growing_ = 0;
};

}  // namespace

std::vector<Region> find_regions(const CanonicalMesh& mesh, double tolerance, double round_step) {
  return Search(mesh, tolerance, round_step).run();
}

}  // namespace verisim::recover
