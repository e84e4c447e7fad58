// What a search for surfaces knows of a mesh, and the regions that it has found so far.
#pragma once

#include <optional>
#include <vector>

#include "engine/geometry/entity.hpp"
#include "engine/geometry/recover.hpp"
#include "engine/geometry/recover/facets.hpp"
#include "engine/geometry/recover/piece.hpp"

namespace verisim::recover {

/// A round surface as it was fitted.
struct RoundFit {
  SurfaceValue surface;
  bool by_inner;  ///< to vertices off sharp edges alone: those on them may be further from it
};

struct TakenRegion {
  Surface surface;
  std::vector<std::uint32_t> triangles;
  std::optional<RoundFit> fit;  ///< none: a plane, or another surface
};

class Regions {
 public:
  /// @param tolerance  m, of vertices from their surface  @param round_step  rad, see find_regions
  Regions(const CanonicalMesh& mesh, double tolerance, double round_step, const RecoverThresholds& thresholds);

  [[nodiscard]] bool is_free(std::uint32_t triangle) const { return of_triangle_[triangle] == kNone; }
  [[nodiscard]] bool is_free_facet(std::uint32_t facet) const { return taken_of_facet_[facet] == 0; }
  /// A triangle or two in a plane: more are not by chance in one.
  [[nodiscard]] bool is_small(std::uint32_t facet) const { return facets.all[facet].triangles.size() <= 2; }
  /// Can the two stand for the same smooth surface, for all that their normals say?
  [[nodiscard]] bool is_smooth(std::uint32_t triangle, std::uint32_t beside) const;
  /// kNone: free
  [[nodiscard]] std::uint32_t region_of(std::uint32_t triangle) const { return of_triangle_[triangle]; }
  [[nodiscard]] double area_of(const std::vector<std::uint32_t>& triangles) const;

  /// The test for pieces of a surface, the material on the side where the seed has it.
  [[nodiscard]] Piece piece_of(const RoundFit& fit, std::uint32_t seed) const;
  /// Their vertices, each once. @param inner  those off sharp edges alone
  [[nodiscard]] std::vector<Vector3d> points_of_triangles(const std::vector<std::uint32_t>& triangles,
                                                          bool inner) const;
  [[nodiscard]] std::vector<Vector3d> points_of(std::vector<std::uint32_t> vertices, bool inner) const;

  void take_round(const RoundFit& fit, std::vector<std::uint32_t> triangles);
  void take_plane(std::uint32_t facet);
  void take_other(std::vector<std::uint32_t> triangles);
  /// One free triangle more.
  void add(std::uint32_t region, std::uint32_t triangle);
  /// All triangles of a region to another; it stays, without any.
  void merge(std::uint32_t region, std::uint32_t into);
  /// Its triangles are free again; it stays, without any.
  void release(std::uint32_t region);

  const CanonicalMesh& mesh;
  const double tolerance;
  const RecoverThresholds thresholds;
  const double cos_smooth;  ///< of the largest angle between neighbouring facets of one round surface
  const double cos_step;    ///< of the longest step around it
  const Facets facets;
  std::vector<TakenRegion> all;

 private:
  void take(TakenRegion region);

  std::vector<bool> is_rim_;                   // vertices: on a sharp or open edge
  std::vector<std::uint32_t> of_triangle_;     // numbers of regions
  std::vector<std::uint32_t> taken_of_facet_;  // how many of its triangles
};

}  // namespace verisim::recover
