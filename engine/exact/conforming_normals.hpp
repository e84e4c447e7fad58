// The directions in which a ball, or a corner as a ball without a radius, that fits closely into a hollow may be
// stopped by it. The ball's centre stays within the hollow shrunk by the ball's radius. Where the centre can pass much
// of that within a step, because the ball is hardly smaller than the hollow, or because it lies in a cone and its
// centre is on the axis, one tangent plane says little of it. The hollow is convex (round a cylinder's, cone's or
// ball's inside; across a torus's tube), so its other tangent planes hold as well: none stops the ball where the hollow
// does not. Base coordinates [m]. Private to this folder.
#pragma once

#include <array>
#include <optional>

#include "engine/geometry/analytic_surface.hpp"

namespace verisim::exact {

/// Angles from the closest normal [rad]. What rests comes to lie within half of the first, which is as much as its
/// force goes to and fro. Each is less than three times the one before: what is stopped where two of their planes meet,
/// at (a + b) / 2, instead of where it would rest, between a and b, is then nearer to it than it was. At four times it
/// goes to and fro. Planes at a and b leave a part (b - a)^2 / 8 of the clearance between them.
inline constexpr std::array<double, 12> kTurns = {0.0005, 0.0014, 0.004, 0.0115, 0.033, 0.092,
                                                  0.25,   0.45,   0.75,  1.1,    1.6,   2.3};
/// Angles along an arc from its closest place [rad], as far as the next segments' ends, which have rows of their own.
/// Twice the one before: a body that is held at several of its rims comes nearer by less at each.
inline constexpr std::array<double, 8> kTurnsAlong = {0.001, 0.002, 0.004, 0.008, 0.016, 0.032, 0.064, 0.128};

/// Where a point lies within a hollow surface.
struct HollowPlace {
  Vector3d pivot;           ///< the point for which the tangent planes of all conforming normals are equally far
  double radius = 0;        ///< m: how far the point may move until the closest normal has turned by a radian
  Vector3d axis;            ///< unit, about which the normals turn; not of a ball's inside
  bool is_in_ball = false;  ///< the normals lean to all sides
  bool is_in_tube = false;  ///< of a torus
};
/// Nothing for a plane, and where the surface is not hollow.
[[nodiscard]] std::optional<HollowPlace> hollow_place(const AnalyticSurface& surface, const Vector3d& p);

/// Other normals of a hollow surface, beside the one that is closest to a point.
struct ConformingNormals {
  static constexpr std::size_t kMax = 56;
  std::size_t count = 0;
  std::array<Vector3d, kMax> normals;
};
/// @param normal   the closest one
/// @param touches  at that place? A ring lies on many places of a tube at once; those that do not touch yet have the
///                 wider angles only
[[nodiscard]] ConformingNormals conforming_normals(const HollowPlace& place, const Vector3d& normal, bool touches);

}  // namespace verisim::exact
