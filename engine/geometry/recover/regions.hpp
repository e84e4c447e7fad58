// The state of a segmentation: a mesh with its facets, and the regions found so far. A triangle in no region is free.
#pragma once

#include <optional>
#include <vector>

#include "engine/geometry/entity.hpp"
#include "engine/geometry/recover.hpp"
#include "engine/geometry/recover/facets.hpp"
#include "engine/geometry/recover/inlier_test.hpp"

namespace verisim::recover {

/// A curved surface as it was fitted.
struct CurvedFit {
  SurfaceValue surface;
  bool inner_only;  ///< to vertices off sharp edges alone; those on sharp edges may be further from it
};

struct FoundRegion {
  Surface surface;
  std::vector<std::uint32_t> triangles;
  std::optional<CurvedFit> fit;  ///< none: a plane, or another surface
};

class Regions {
 public:
  /// @param tolerance   m, of vertices from their surface
  /// @param round_step  rad, see find_regions
  Regions(const CanonicalMesh& mesh, double tolerance, double round_step, const RecoverThresholds& thresholds);

  [[nodiscard]] bool is_free(std::uint32_t triangle) const { return of_triangle_[triangle] == kNone; }
  /// All its triangles are free.
  [[nodiscard]] bool is_free_facet(std::uint32_t facet) const { return assigned_in_facet_[facet] == 0; }
  /// At most two triangles, as many as a quad has: they may be coplanar by chance.
  [[nodiscard]] bool is_small(std::uint32_t facet) const { return facets.all[facet].triangles.size() <= 2; }
  /// True if two neighbouring triangles can be pieces of one smooth surface, by the angle between their normals.
  [[nodiscard]] bool is_smooth(std::uint32_t triangle, std::uint32_t beside) const;
  /// kNone: free
  [[nodiscard]] std::uint32_t region_of(std::uint32_t triangle) const { return of_triangle_[triangle]; }
  [[nodiscard]] double area_of(const std::vector<std::uint32_t>& triangles) const;  ///< m^2

  /// The inlier test of a surface, with the material on the side where the seed triangle has it.
  [[nodiscard]] InlierTest inlier_test(const CurvedFit& fit, std::uint32_t seed) const;
  /// Their vertices, each once. @param inner_only  leaves out those on sharp edges
  [[nodiscard]] std::vector<Vector3d> points_of_triangles(const std::vector<std::uint32_t>& triangles,
                                                          bool inner_only) const;
  [[nodiscard]] std::vector<Vector3d> points_of(std::vector<std::uint32_t> vertices, bool inner_only) const;

  // @pre of what adds and assigns: the triangles are free, and of a curved surface there is one at least.
  void add_curved(const CurvedFit& fit, std::vector<std::uint32_t> triangles);
  void add_plane(std::uint32_t facet);
  void add_freeform(std::vector<std::uint32_t> triangles);
  /// Adds one free triangle to a region.
  void assign(std::uint32_t region, std::uint32_t triangle);
  /// Moves all triangles of a region into another. The region stays in `all`, empty. @pre they are two
  void merge(std::uint32_t region, std::uint32_t into);
  /// Frees all triangles of a region. The region stays in `all`, empty.
  void release(std::uint32_t region);

  const CanonicalMesh& mesh;
  const double tolerance;  ///< m
  const RecoverThresholds thresholds;
  const double cos_smooth;  ///< of the largest angle between neighbouring facets of one curved surface
  const double cos_step;    ///< of the largest angle around it within one triangle
  const Facets facets;
  std::vector<FoundRegion> all;

 private:
  void add_region(FoundRegion region);

  std::vector<bool> on_sharp_edge_;               // per vertex: on a sharp or open edge
  std::vector<std::uint32_t> of_triangle_;        // per triangle: number of its region
  std::vector<std::uint32_t> assigned_in_facet_;  // per facet: triangles that are not free
};

}  // namespace verisim::recover
