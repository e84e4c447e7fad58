// Neighbourhoods of a facet among the free facets: the samples to which surfaces are fitted.
#pragma once

#include <vector>

#include "engine/geometry/recover/regions.hpp"

namespace verisim::recover {

class Neighborhoods {
 public:
  explicit Neighborhoods(const Regions& regions) : regions_(regions), visited_(regions.facets.all.size(), false) {}

  /// The k-ring of a facet: all free facets that are reached over at most k smooth sides, itself included. Ascending.
  [[nodiscard]] std::vector<std::uint32_t> k_ring(std::uint32_t facet, std::size_t k);
  /// Strips of facets along and across, both together, and k-rings of several sizes; none twice. For each kind of
  /// surface one of them holds enough of it and nothing else.
  [[nodiscard]] std::vector<std::vector<std::uint32_t>> fit_samples(std::uint32_t facet);

 private:
  using Strip = std::vector<std::uint32_t>;
  void extend_strip(std::uint32_t facet, const FacetSide* through, Strip& strip) const;
  [[nodiscard]] std::vector<Strip> strips(std::uint32_t facet) const;

  const Regions& regions_;
  std::vector<bool> visited_;  // per facet, within k_ring()
};

}  // namespace verisim::recover
