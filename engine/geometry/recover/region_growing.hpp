// Region growing: from a sample of facets to a surface and all triangles that lie on it.
#pragma once

#include <optional>
#include <vector>

#include "engine/geometry/recover/regions.hpp"

namespace verisim::recover {

/// A surface and its inliers.
struct Candidate {
  CurvedFit fit;
  std::vector<std::uint32_t> triangles;  ///< ascending
  double area = 0;                       ///< m^2
};

class RegionGrowing {
 public:
  explicit RegionGrowing(const Regions& regions) : regions_(regions), last_pass_(regions.mesh.triangles.size(), 0) {}

  /// Fits a surface of this kind to the vertices of some facets. Grows it from `seed` over free triangles that are
  /// inliers, and fits it again, until no inliers are added. None in three cases: the fit leaves the tolerance; its
  /// vertices are off by more than half of the tolerance (as in a piece of a free form, where it ends); the fit is
  /// ambiguous (fit_ambiguity.hpp).
  /// @param inner_only  fits to vertices off sharp edges alone. A drawn surface that ends at a sharp edge may miss the
  ///                    vertices there by as much as the drawing's tolerance
  [[nodiscard]] std::optional<Candidate> grow_from(const std::vector<std::uint32_t>& facets, Kind kind, bool inner_only,
                                                   std::uint32_t seed);
  /// Adds neighbouring triangles that are loose inliers, if they are no face by themselves: the fans with which
  /// tessellations join two grids.
  void add_fans(Candidate& found);

 private:
  [[nodiscard]] std::vector<std::uint32_t> grow(const CurvedFit& fit, std::uint32_t seed);

  const Regions& regions_;
  std::vector<std::uint32_t> last_pass_;  // per triangle: the pass that visited it last
  std::uint32_t pass_ = 0;
};

}  // namespace verisim::recover
