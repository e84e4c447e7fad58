// Does a triangle stand for a piece of a surface?
//
// A tessellation's triangles have their corners on the surface and cover a grid of it: seen in the surface's own
// coordinates (around and along its axis) they are small and none is turned over. That is asked there, not in space: a
// thin ring of tube in long facets bends by more than its own radius within one of them, and the flat end of a cone
// has all its corners on the cone.
#pragma once

#include "engine/geometry/recover.hpp"
#include "engine/geometry/recover/canonical_mesh.hpp"
#include "engine/geometry/recover/surface_value.hpp"

namespace verisim::recover {

struct PieceLimits {
  double tolerance;                 ///< m, of corners from the surface
  const std::vector<bool>* is_rim;  ///< vertices that may be further from it; nullptr: none
  double cos_step;                  ///< cosine of the longest step around it
  bool inside_out;                  ///< the material is outside of it
  RecoverThresholds thresholds;
};

class Piece {
 public:
  Piece(const CanonicalMesh& mesh, const SurfaceValue& surface, const PieceLimits& limits)
      : mesh_(mesh), surface_(surface), limits_(limits) {}

  /// As tessellations mostly are: a triangle no longer than a step each way, and nearly tangent.
  [[nodiscard]] bool is_regular(std::uint32_t triangle) const;
  /// As they can be where two of their grids meet: long fans along a tube. Not evidence, but what is left beside it.
  [[nodiscard]] bool is_possible(std::uint32_t triangle) const;

 private:
  struct Corners;
  [[nodiscard]] bool is_on(std::uint32_t triangle) const;
  struct Cover {
    double area, length;
  };
  [[nodiscard]] Cover cover_of(const Corners& corners) const;

  const CanonicalMesh& mesh_;
  SurfaceValue surface_;
  PieceLimits limits_;
};

}  // namespace verisim::recover
