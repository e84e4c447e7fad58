#include "engine/geometry/recover/region_search.hpp"

#include <algorithm>
#include <optional>

#include "engine/geometry/recover/growth.hpp"
#include "engine/geometry/recover/regions.hpp"
#include "engine/geometry/recover/second_thoughts.hpp"
#include "engine/geometry/recover/surroundings.hpp"

namespace verisim::recover {

namespace {

constexpr Kind kRoundKinds[] = {Kind::cylinder, Kind::cone, Kind::sphere, Kind::torus};
constexpr std::size_t kAgain = 3;   // steps from what was taken
constexpr std::size_t kBarren = 2;  // steps from where nothing fits
constexpr std::size_t kFewFacets = 4;

class Search {
 public:
  Search(const CanonicalMesh& mesh, double tolerance, double round_step, const RecoverThresholds& thresholds)
      : regions_(mesh, tolerance, round_step, thresholds),
        facets_(regions_.facets.all),
        surroundings_(regions_),
        growth_(regions_),
        untried_(facets_.size(), true) {}

  std::vector<Region> run() {
    while (try_all() || take_small_planes()) {
    }
    give_to_larger(regions_);
    take_remaining_planes();
    release_patches(regions_);
    take_rest();
    std::vector<Region> result;
    for (TakenRegion& region : regions_.all) {
      if (!region.triangles.empty()) result.push_back({std::move(region.surface), std::move(region.triangles)});
    }
    return result;
  }

 private:
  bool try_all() {
    bool found = false;
    for (std::uint32_t facet = 0; facet < facets_.size(); ++facet) {
      if (untried_[facet] && regions_.is_free_facet(facet)) found |= try_from(facet);
    }
    return found;
  }

  /// They come late: until the round surfaces around are found, they may be pieces of one.
  bool take_small_planes() {
    bool found = false;
    for (std::uint32_t facet = 0; facet < facets_.size(); ++facet) {
      if (!regions_.is_free_facet(facet) || !borders_as_a_plane(facet)) continue;
      regions_.take_plane(facet);
      try_again_beside(regions_.all.back().triangles);
      found = true;
    }
    return found;
  }

  bool try_from(std::uint32_t facet) {
    untried_[facet] = false;
    std::optional<Candidate> best = best_from(facet);
    if (best) {
      growth_.add_fans(*best);
      regions_.take_round(best->fit, std::move(best->triangles));
    } else if (!regions_.is_small(facet) && borders_as_a_plane(facet)) {
      regions_.take_plane(facet);
    } else {
      for (const std::uint32_t near : surroundings_.around(facet, kBarren)) untried_[near] = false;
      return false;
    }
    try_again_beside(regions_.all.back().triangles);
    return true;
  }

  std::optional<Candidate> best_from(std::uint32_t facet) {
    const std::uint32_t seed = *std::ranges::max_element(facets_[facet].triangles, {},
                                                         [&](std::uint32_t t) { return regions_.mesh.areas[t]; });
    const std::vector<std::vector<std::uint32_t>> samples = surroundings_.samples(facet);
    std::optional<Candidate> best;
    for (const Kind kind : kRoundKinds) {
      for (const std::vector<std::uint32_t>& sample : samples) {
        if (sample.size() < 3) continue;
        for (const bool by_inner : {false, true}) {
          if (by_inner && kind != Kind::torus) continue;  // through two circles pass cones and spheres, always
          std::optional<Candidate> next = growth_.from(sample, kind, by_inner, seed);
          if (next && (!best || next->area > regions_.thresholds.larger_by_far * best->area)) best = std::move(next);
        }
      }
    }
    return best;
  }

  /// What a smooth neighbour measures across the common side.
  [[nodiscard]] double width(std::uint32_t facet, const FacetSide& side) const {
    return facets_[facet].area / side.length;
  }

  /// A piece of a round surface has neighbours about as wide as itself; a plane that passes into one has narrow ones.
  [[nodiscard]] bool borders_as_a_plane(std::uint32_t facet) const {
    return std::ranges::all_of(facets_[facet].sides, [&](const FacetSide& side) {
      return !side.smooth || width(side.facet, side) < regions_.thresholds.narrower * width(facet, side);
    });
  }

  [[nodiscard]] bool is_mostly_sharp(std::uint32_t facet) const {
    double sharp = 0, all = 0;
    for (const FacetSide& side : facets_[facet].sides) {
      all += side.length;
      if (!side.smooth) sharp += side.length;
    }
    return sharp > regions_.thresholds.mostly_sharp * all;
  }

  /// Planes that meet at small angles are few; pieces of a round or free surface are many, or border on one.
  [[nodiscard]] bool are_planes(const std::vector<std::uint32_t>& joined) const {
    return joined.size() <= kFewFacets && std::ranges::all_of(joined, [&](std::uint32_t facet) {
             return std::ranges::all_of(facets_[facet].sides, [&](const FacetSide& side) {
               return !side.smooth || regions_.is_free_facet(side.facet);
             });
           });
  }

  /// Facets near what was taken last have other surroundings now.
  void try_again_beside(const std::vector<std::uint32_t>& triangles) {
    std::vector<std::uint32_t> beside;
    for (const std::uint32_t t : triangles) {
      for (const std::uint32_t n : regions_.mesh.neighbors[t]) {
        if (n == kNone) continue;
        const std::uint32_t facet = regions_.facets.of_triangle[n];
        if (regions_.is_free_facet(facet)) beside.push_back(facet);
      }
    }
    std::ranges::sort(beside);
    beside.erase(std::unique(beside.begin(), beside.end()), beside.end());
    for (const std::uint32_t facet : beside) {
      for (const std::uint32_t near : surroundings_.around(facet, kAgain)) untried_[near] = true;
    }
  }

  /// Planes that meet at small angles.
  void take_remaining_planes() {
    std::vector<bool> seen(facets_.size(), false);
    for (std::uint32_t facet = 0; facet < facets_.size(); ++facet) {
      if (seen[facet] || !regions_.is_free_facet(facet)) continue;
      const std::vector<std::uint32_t> joined = surroundings_.around(facet, facets_.size());
      for (const std::uint32_t f : joined) seen[f] = true;
      const bool planes = are_planes(joined);
      for (const std::uint32_t f : joined) {
        if (planes || is_mostly_sharp(f)) regions_.take_plane(f);
      }
    }
  }

  /// What fits nothing, as far as it is smooth.
  void take_rest() {
    for (std::uint32_t t = 0; t < regions_.mesh.triangles.size(); ++t) {
      if (regions_.is_free(t)) regions_.take_other(smooth_rest(t));
    }
  }

  [[nodiscard]] std::vector<std::uint32_t> smooth_rest(std::uint32_t seed) {
    std::vector<std::uint32_t> found = {seed};
    met_.resize(regions_.mesh.triangles.size(), false);
    met_[seed] = true;
    for (std::size_t i = 0; i < found.size(); ++i) {
      for (const std::uint32_t t : regions_.mesh.neighbors[found[i]]) {
        if (t == kNone || met_[t] || !regions_.is_free(t) || !regions_.is_smooth(t, found[i])) continue;
        met_[t] = true;
        found.push_back(t);
      }
    }
    std::ranges::sort(found);
    return found;
  }

  Regions regions_;
  const std::vector<Facet>& facets_;
  Surroundings surroundings_;
  Growth growth_;
  std::vector<bool> untried_;  // facets whose surroundings have changed since they were tried
  std::vector<bool> met_;      // triangles that are in the rest
};

}  // namespace

std::vector<Region> find_regions(const CanonicalMesh& mesh, double tolerance, double round_step,
                                 const RecoverThresholds& thresholds) {
  return Search(mesh, tolerance, round_step, thresholds).run();
}

}  // namespace verisim::recover
