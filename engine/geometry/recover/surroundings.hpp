// What lies around a facet, as far as it is free: the samples that surfaces are fitted to.
#pragma once

#include <vector>

#include "engine/geometry/recover/regions.hpp"

namespace verisim::recover {

class Surroundings {
 public:
  explicit Surroundings(const Regions& regions) : regions_(regions), met_(regions.facets.all.size(), false) {}

  /// Everything that is free and smoothly joined to a facet, up to `most` steps away. Ascending.
  [[nodiscard]] std::vector<std::uint32_t> around(std::uint32_t facet, std::size_t most);
  /// Rows through the facet, both together, and what is around it: of each kind of surface one will hold enough and
  /// nothing else. None twice.
  [[nodiscard]] std::vector<std::vector<std::uint32_t>> samples(std::uint32_t facet);

 private:
  using Row = std::vector<std::uint32_t>;
  void walk(std::uint32_t facet, const FacetSide* through, Row& row) const;
  [[nodiscard]] std::vector<Row> rows(std::uint32_t facet) const;

  const Regions& regions_;
  std::vector<bool> met_;  // facets, while around() looks
};

}  // namespace verisim::recover
