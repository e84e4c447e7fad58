#include "engine/geometry/recover/surroundings.hpp"

#include <algorithm>
#include <array>

namespace verisim::recover {

namespace {

constexpr std::array<std::size_t, 4> kAround = {2, 3, 6, 12};  // steps
constexpr int kSteps = 4;                                      // facets of a row to each side
constexpr double kSideParallel = 0.7;                          // cosine

}  // namespace

std::vector<std::uint32_t> Surroundings::around(std::uint32_t facet, std::size_t most) {
  std::vector<std::uint32_t> found = {facet};
  met_[facet] = true;
  std::size_t begin = 0;
  for (std::size_t step = 0; step < most && begin < found.size(); ++step) {
    const std::size_t end = found.size();
    for (; begin < end; ++begin) {
      for (const FacetSide& side : regions_.facets.all[found[begin]].sides) {
        if (!side.smooth || met_[side.facet] || !regions_.is_free_facet(side.facet)) continue;
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
void Surroundings::walk(std::uint32_t facet, const FacetSide* through, Row& row) const {
  for (int step = 0; step < kSteps && through != nullptr; ++step) {
    const std::uint32_t next = through->facet;
    if (!through->smooth || !regions_.is_free_facet(next) || std::ranges::find(row, next) != row.end()) return;
    row.push_back(next);
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

/// Across the facet's longest side, and across the one that is most at right angles to that.
std::vector<Surroundings::Row> Surroundings::rows(std::uint32_t facet) const {
  const std::vector<FacetSide>& sides = regions_.facets.all[facet].sides;
  const FacetSide* longest = nullptr;
  for (const FacetSide& side : sides) {
    if (side.smooth && (longest == nullptr || side.length > longest->length)) longest = &side;
  }
  std::vector<Row> result;
  if (longest == nullptr) return result;
  for (const bool across : {false, true}) {
    Row row = {facet};
    for (const FacetSide& side : sides) {
      const bool is_parallel = std::abs(side.direction.dot(longest->direction)) > kSideParallel;
      if (side.smooth && is_parallel != across) walk(facet, &side, row);
    }
    std::ranges::sort(row);
    row.erase(std::unique(row.begin(), row.end()), row.end());
    result.push_back(std::move(row));
  }
  return result;
}

std::vector<std::vector<std::uint32_t>> Surroundings::samples(std::uint32_t facet) {
  std::vector<Row> result = rows(facet);
  const auto add = [&](Row facets) {
    if (std::ranges::find(result, facets) == result.end()) result.push_back(std::move(facets));
  };
  if (!result.empty()) {
    Row cross;  // of a ring of tube one row is a cone and the other nearly a cylinder
    std::ranges::set_union(result[0], result[1], std::back_inserter(cross));
    add(std::move(cross));
  }
  for (const std::size_t steps : kAround) add(around(facet, steps));
  return result;
}

}  // namespace verisim::recover
