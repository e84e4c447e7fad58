// The directions in which a ball, or a corner as a ball without a radius, that fits closely into a hollow may be
// stopped by it. The ball's centre stays within the hollow shrunk by the ball's radius. Where the centre can pass much
// of that within a step, because the ball is hardly smaller than the hollow, or because it lies in a cone and its
// centre is on the axis, one tangent plane says little of it. The hollow is convex (round a cylinder's, cone's or
// ball's inside; across a torus's tube), so its other tangent planes hold as well: none stops the ball where the hollow
// does not. Base coordinates [m]. Private to this folder.
#pragma once

#include <array>
#include <optional>

#include "engine/base/pinned_math.hpp"
#include "engine/geometry/analytic_surface.hpp"

namespace verisim::exact {

/// Angles from the closest normal [rad], and, below, of an arc's places from its closest one. What rests comes to lie
/// within half of the first, which is as much as its force goes to and fro. Two rules choose the others.
///
/// If planes are hard, what they hold lies where two of them meet. Each is less than three times the one before: what
/// is stopped where two planes meet, at (a + b) / 2, instead of where it would rest, between a and b, is then nearer to
/// it than it was. At four times it goes to and fro. Planes at a and b leave a part (b - a)^2 / 8 of the clearance.
///
/// If a force presses several of them, it turns by a part k of the angle by which the place goes round within the step,
/// and by the rest in the next one. What is off by an angle is off by 1 - 1 / k times that angle a step later: below
/// k = 1/2 it goes to and fro with growing force. In a hollow k would be 1. Rows of the same stiffness have 0.1 and
/// less: most of them lie near the closest place. Where stiffness grows with the square of the angle, k is at least 1/2
/// if each is twice the one before, 0.4 at 2.2 times, and 1/4 of normals that lean to all sides; that of the closest
/// place itself is as small (conforming_normals_test). Stiffer ones are nearer to a rigid body, and part bodies that
/// are found wedged the faster.
inline constexpr std::array<double, 14> kTurns = {0.001, 0.0022, 0.0048, 0.0106, 0.0234, 0.0515, 0.113,
                                                  0.25,  0.42,   0.7,    1.05,   1.55,   2.25,   pinned::kPi};
/// As far as the next segments' ends, which have rows of their own.
inline constexpr std::array<double, 8> kTurnsAlong = {0.001, 0.002, 0.004, 0.008, 0.016, 0.032, 0.064, 0.128};
/// A normal, or a place along an arc, at this angle is as stiff as the closest one would be alone [rad].
inline constexpr double kTurnOfOne = 0.02, kLeanOfOne = 0.1, kTurnAlongOfOne = 0.004;
/// Likewise of a ring, of which places are held along it and round its tube: as a ball's, whose normals lean to all
/// sides.
inline constexpr double kTurnAlongRingOfOne = 0.05;
/// Likewise of a rim that moves: if it wedges within a step, it is parted less violently.
inline constexpr double kTurnAlongOfOneMoving = 0.01;

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
  static constexpr std::size_t kMax = 64;
  std::size_t count = 0;
  std::array<Vector3d, kMax> normals;
  std::array<double, kMax> parts;  ///< times the closest one's stiffness
  double part_of_closest = 1;      ///< what is left of it, if there are others
};
/// @param normal   the closest one
/// @param touches  at that place? A ring lies on many places of a tube at once; those that do not touch yet have the
///                 wider angles only
/// @param stays    there? Then a ring has the narrower angles only: it has a row for what it slides to
[[nodiscard]] ConformingNormals conforming_normals(const HollowPlace& place, const Vector3d& normal, bool touches,
                                                   bool stays);

}  // namespace verisim::exact
