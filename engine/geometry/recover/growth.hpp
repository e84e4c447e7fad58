// From a sample to a surface with all triangles that stand for it.
#pragma once

#include <optional>
#include <vector>

#include "engine/geometry/recover/regions.hpp"

namespace verisim::recover {

struct Candidate {
  RoundFit fit;
  std::vector<std::uint32_t> triangles;  ///< ascending
  double area = 0;                       ///< m^2
};

class Growth {
 public:
  explicit Growth(const Regions& regions) : regions_(regions), mark_(regions.mesh.triangles.size(), 0) {}

  /// The surface of this kind that passes through facets, grown over free triangles from the seed and fitted again
  /// until it covers no more. Where a drawn surface ends at a sharp edge, its vertices are off by as much as the
  /// drawing's tolerance: with `by_inner` those are not asked. None if the vertices that it covers do not make it
  /// evident, or are only just within the tolerance: a piece cut from a free form is, where it ends.
  [[nodiscard]] std::optional<Candidate> from(const std::vector<std::uint32_t>& facets, Kind kind, bool by_inner,
                                              std::uint32_t seed);
  /// Adds what is not regular beside it, but can be a piece of it and is no face by itself.
  void add_fans(Candidate& found);

 private:
  [[nodiscard]] std::vector<std::uint32_t> grow(const RoundFit& fit, std::uint32_t seed);

  const Regions& regions_;
  std::vector<std::uint32_t> mark_;  // triangles: the growing that has met them
  std::uint32_t growing_ = 0;
};

}  // namespace verisim::recover
