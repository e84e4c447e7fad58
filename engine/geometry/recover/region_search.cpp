#include "engine/geometry/recover/region_search.hpp"

#include <algorithm>
#include <optional>

#include "engine/geometry/recover/neighborhoods.hpp"
#include "engine/geometry/recover/region_growing.hpp"
#include "engine/geometry/recover/region_merging.hpp"
#include "engine/geometry/recover/regions.hpp"

namespace verisim::recover {

namespace {

constexpr Kind kCurvedKinds[] = {Kind::cylinder, Kind::cone, Kind::sphere, Kind::torus};

class Search {
 public:
  Search(const CanonicalMesh& mesh, double tolerance, double round_step, const RecoverThresholds& thresholds)
      : regions_(mesh, tolerance, round_step, thresholds),
        facets_(regions_.facets.all),
        neighborhoods_(regions_),
        growing_(regions_),
        untried_(facets_.size(), true) {}

  std::vector<Region> run() {
    while (grow_from_all() || add_small_planes()) {
    }
    merge_regions(regions_);
    add_remaining_planes();
    release_freeform_patches(regions_);
    add_freeform_rest();
    std::vector<Region> result;
    for (FoundRegion& region : regions_.all) {
      if (!region.triangles.empty()) result.push_back({std::move(region.surface), std::move(region.triangles)});
    }
    return result;
  }

 private:
  bool grow_from_all() {
    bool found = false;
    for (std::uint32_t facet = 0; facet < facets_.size(); ++facet) {
      if (untried_[facet] && regions_.is_free_facet(facet)) found |= grow_from_facet(facet);
    }
    return found;
  }

  /// Small facets become planes last: before the curved surfaces around are found, they may be pieces of one.
  bool add_small_planes() {
    bool found = false;
    for (std::uint32_t facet = 0; facet < facets_.size(); ++facet) {
      if (!regions_.is_free_facet(facet) || !has_plane_borders(facet)) continue;
      regions_.add_plane(facet);
      retry_beside(regions_.all.back().triangles);
      found = true;
    }
    return found;
  }

  bool grow_from_facet(std::uint32_t facet) {
    untried_[facet] = false;
    std::optional<Candidate> best = best_from(facet);
    if (best) {
      growing_.add_fans(*best);
      regions_.add_curved(best->fit, std::move(best->triangles));
    } else if (!regions_.is_small(facet) && has_plane_borders(facet)) {
      regions_.add_plane(facet);
    } else {
      for (const std::uint32_t near : neighborhoods_.k_ring(facet, regions_.thresholds.failed_steps))
        untried_[near] = false;
      return false;
    }
    retry_beside(regions_.all.back().triangles);
    return true;
  }

  std::optional<Candidate> best_from(std::uint32_t facet) {
    const std::uint32_t seed = *std::ranges::max_element(facets_[facet].triangles, {},
                                                         [&](std::uint32_t t) { return regions_.mesh.areas[t]; });
    const std::vector<std::vector<std::uint32_t>> samples = neighborhoods_.fit_samples(facet);
    std::optional<Candidate> best;
    for (const Kind kind : kCurvedKinds) {
      for (const std::vector<std::uint32_t>& sample : samples) {
        if (sample.size() < 3) continue;
        for (const bool inner_only : {false, true}) {
          if (inner_only && kind != Kind::torus) continue;  // a cone and a sphere pass through any two circles
          std::optional<Candidate> next = growing_.grow_from(sample, kind, inner_only, seed);
          if (next && (!best || next->area > regions_.thresholds.larger_by * best->area)) best = std::move(next);
        }
      }
    }
    return best;
  }

  /// Extent of a facet across one of its sides [m].
  [[nodiscard]] double width(std::uint32_t facet, const FacetSide& side) const {
    return facets_[facet].area / side.length;
  }

  /// True if each smooth neighbour is much narrower. A piece of a curved surface has neighbours about as wide as
  /// itself; a plane that goes over into a curved surface has narrow ones.
  [[nodiscard]] bool has_plane_borders(std::uint32_t facet) const {
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

  /// True if facets that meet smoothly are planes: they are few, and none borders smoothly on a region. Pieces of a
  /// curved or free surface are many, or border on one.
  [[nodiscard]] bool are_planes(const std::vector<std::uint32_t>& joined) const {
    return joined.size() <= regions_.thresholds.few_facets && std::ranges::all_of(joined, [&](std::uint32_t facet) {
             return std::ranges::all_of(facets_[facet].sides, [&](const FacetSide& side) {
               return !side.smooth || regions_.is_free_facet(side.facet);
             });
           });
  }

  /// Marks the facets near a new region as untried: their neighbourhoods have changed.
  void retry_beside(const std::vector<std::uint32_t>& triangles) {
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
      for (const std::uint32_t near : neighborhoods_.k_ring(facet, regions_.thresholds.retry_steps))
        untried_[near] = true;
    }
  }

  /// Planes that meet at small angles, and those with mostly sharp borders.
  void add_remaining_planes() {
    std::vector<bool> seen(facets_.size(), false);
    for (std::uint32_t facet = 0; facet < facets_.size(); ++facet) {
      if (seen[facet] || !regions_.is_free_facet(facet)) continue;
      const std::vector<std::uint32_t> joined = neighborhoods_.k_ring(facet, facets_.size());
      for (const std::uint32_t f : joined) seen[f] = true;
      const bool planes = are_planes(joined);
      for (const std::uint32_t f : joined) {
        if (planes || is_mostly_sharp(f)) regions_.add_plane(f);
      }
    }
  }

  /// Free triangles become freeform regions, one per smooth component.
  void add_freeform_rest() {
    for (std::uint32_t t = 0; t < regions_.mesh.triangles.size(); ++t) {
      if (regions_.is_free(t)) regions_.add_freeform(smooth_component(t));
    }
  }

  [[nodiscard]] std::vector<std::uint32_t> smooth_component(std::uint32_t seed) {
    std::vector<std::uint32_t> found = {seed};
    visited_.resize(regions_.mesh.triangles.size(), false);
    visited_[seed] = true;
    for (std::size_t i = 0; i < found.size(); ++i) {
      for (const std::uint32_t t : regions_.mesh.neighbors[found[i]]) {
        if (t == kNone || visited_[t] || !regions_.is_free(t) || !regions_.is_smooth(t, found[i])) continue;
        visited_[t] = true;
        found.push_back(t);
      }
    }
    std::ranges::sort(found);
    return found;
  }

  Regions regions_;
  const std::vector<Facet>& facets_;
  Neighborhoods neighborhoods_;
  RegionGrowing growing_;
  std::vector<bool> untried_;  // per facet: its neighbourhood has changed since it was tried
  std::vector<bool> visited_;  // per triangle: in a smooth component
};

}  // namespace

std::vector<Region> find_regions(const CanonicalMesh& mesh, double tolerance, double round_step,
                                 const RecoverThresholds& thresholds) {
  return Search(mesh, tolerance, round_step, thresholds).run();
}

}  // namespace verisim::recover
