// The directions in which a ball, or a corner as a ball without a radius, that fits closely into a hollow may be
// stopped by it. The ball's centre stays within the hollow shrunk by the ball's radius. Where the centre can pass much
// of that within a step, because the ball is hardly smaller than the hollow, or because it lies in a cone and its
// centre is on the axis, one tangent plane says little of it. The hollow is convex (round a cylinder's, cone's or
// ball's inside; across a torus's tube), so its other tangent planes hold as well: none stops the ball where the hollow
// does not. Base coordinates [m]. Private to this folder.
#pragma once

#include <array>
#include <span>

#include "engine/geometry/analytic_surface.hpp"

namespace verisim::exact {

/// Angles from the closest normal [rad]. What rests comes to lie within half of the first, which is as much as its
/// force goes to and fro. Planes at a and b leave a part (b - a)^2 / 8 of the clearance between them.
inline constexpr std::array<double, 12> kTurns = {0.0004, 0.0015, 0.006, 0.02, 0.05, 0.12,
                                                  0.25,   0.45,   0.75,  1.1,  1.6,  2.3};

/// Other normals of a hollow surface, beside the one that is closest to a point.
struct ConformingNormals {
  static constexpr std::size_t kMax = 40;
  Vector3d pivot;     ///< the point for which tangent planes of all of these normals are equally far
  double radius = 0;  ///< m: how far the point may move until the closest normal has turned by a radian
  std::size_t count = 0;
  std::array<Vector3d, kMax> normals;
};

/// @param p, at  a point within the hollow, and the surface seen from it
/// @returns no normals for a plane and for a surface that is not hollow
[[nodiscard]] ConformingNormals conforming_normals(const AnalyticSurface& surface, const Vector3d& p,
                                                   const SurfaceAt& at);

}  // namespace verisim::exact
