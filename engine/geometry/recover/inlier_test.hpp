// The inlier test of region growing: is a triangle a piece of a surface?
//
// A tessellation's triangles have their corners on the surface and cover a grid of it. In the surface's own parameters
// (around and along its axis) they are small, and none is turned over. The test is made in these parameters and not in
// space, for two reasons: a thin ring of tube in long facets bends by more than its own radius within one facet, and
// the flat end of a cone has all its corners on the cone.
#pragma once

#include "engine/geometry/recover.hpp"
#include "engine/geometry/recover/canonical_mesh.hpp"
#include "engine/geometry/recover/surface_value.hpp"

namespace verisim::recover {

struct InlierLimits {
  double tolerance;                        ///< m, of corners from the surface
  const std::vector<bool>* on_sharp_edge;  ///< per vertex: it may be off by sharp_edge_slack; nullptr: none may
  double cos_step;                         ///< cosine of a triangle's largest angle around the surface
  bool is_hole;                            ///< the material is outside of the surface
  RecoverThresholds thresholds;
};

class InlierTest {
 public:
  InlierTest(const CanonicalMesh& mesh, const SurfaceValue& surface, const InlierLimits& limits)
      : mesh_(mesh), surface_(surface), limits_(limits) {}

  /// True for a triangle as tessellations usually have: corners on the surface, at most one step in both directions,
  /// nearly tangent. Such triangles are evidence for the surface.
  [[nodiscard]] bool is_inlier(std::uint32_t triangle) const;
  /// True for a triangle as tessellations may have where two grids meet: a long fan along a tube. Such triangles are no
  /// evidence; they may be added to a surface that others support.
  [[nodiscard]] bool is_loose_inlier(std::uint32_t triangle) const;

 private:
  struct Corners;
  [[nodiscard]] bool is_on_surface(std::uint32_t triangle) const;
  /// The triangle's image in the surface's parameters, in lengths on the surface.
  struct ParameterImage {
    double area;    ///< m^2, negative if turned over
    double length;  ///< m, longest side
  };
  [[nodiscard]] ParameterImage parameter_image(const Corners& corners) const;

  const CanonicalMesh& mesh_;
  SurfaceValue surface_;
  InlierLimits limits_;
};

}  // namespace verisim::recover
