#include "engine/geometry/recover/neighborhoods.hpp"

#include <algorithm>

namespace verisim::recover {

std::vector<std::uint32_t> Neighborhoods::k_ring(std::uint32_t facet, std::size_t k) {
  std::vector<std::uint32_t> found = {facet};
  visited_[facet] = true;
  std::size_t begin = 0;
  for (std::size_t step = 0; step < k && begin < found.size(); ++step) {
    const std::size_t end = found.size();
    for (; begin < end; ++begin) {
      for (const FacetSide& side : regions_.facets.all[found[begin]].sides) {
        if (!side.smooth || visited_[side.facet] || !regions_.is_free_facet(side.facet)) continue;
        visited_[side.facet] = true;
        found.push_back(side.facet);
      }
    }
  }
  for (const std::uint32_t f : found) visited_[f] = false;
  std::ranges::sort(found);
  return found;
}

/// Extends a strip of facets: each facet is left through the side opposite to the one through which it was entered.
void Neighborhoods::extend_strip(std::uint32_t facet, const FacetSide* through, Strip& strip) const {
  for (std::size_t step = 0; step < regions_.thresholds.strip_steps && through != nullptr; ++step) {
    const std::uint32_t next = through->facet;
    if (!through->smooth || !regions_.is_free_facet(next) || std::ranges::find(strip, next) != strip.end()) return;
    strip.push_back(next);
    const FacetSide* onward = nullptr;
    double best = 0;
    for (const FacetSide& side : regions_.facets.all[next].sides) {
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

/// Two strips: across the facet's longest smooth side and those parallel to it, and across its other sides.
std::vector<Neighborhoods::Strip> Neighborhoods::strips(std::uint32_t facet) const {
  const std::vector<FacetSide>& sides = regions_.facets.all[facet].sides;
  const FacetSide* longest = nullptr;
  for (const FacetSide& side : sides) {
    if (side.smooth && (longest == nullptr || side.length > longest->length)) longest = &side;
  }
  std::vector<Strip> result;
  if (longest == nullptr) return result;
  for (const bool across : {false, true}) {
    Strip strip = {facet};
    for (const FacetSide& side : sides) {
      const bool is_parallel = std::abs(side.direction.dot(longest->direction)) > regions_.thresholds.side_parallel;
      if (side.smooth && is_parallel != across) extend_strip(facet, &side, strip);
    }
    std::ranges::sort(strip);
    strip.erase(std::unique(strip.begin(), strip.end()), strip.end());
    result.push_back(std::move(strip));
  }
  return result;
}

std::vector<std::vector<std::uint32_t>> Neighborhoods::fit_samples(std::uint32_t facet) {
  std::vector<Strip> result = strips(facet);
  const auto add = [&](Strip facets) {
    if (std::ranges::find(result, facets) == result.end()) result.push_back(std::move(facets));
  };
  if (!result.empty()) {
    Strip cross;  // in a ring of tube one strip is a cone and the other nearly a cylinder
    std::ranges::set_union(result[0], result[1], std::back_inserter(cross));
    add(std::move(cross));
  }
  for (const std::size_t steps : regions_.thresholds.ring_sizes) add(k_ring(facet, steps));
  return result;
}

}  // namespace verisim::recover
