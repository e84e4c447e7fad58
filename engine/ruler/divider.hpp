// A surface that divides space in two: plane, cylinder, cone, sphere. What the solids of the ruler are made of.
//
// Signed distance g(x) [m], negative inside (below the plane, within the radius). It is never larger than the distance
// to the surface, changes by at most 1 m per m, and has a unit gradient but on the axis or at the centre, where
// `bend_radius` is 0. Written for the ruler alone: it shares no code with engine/geometry.
#pragma once

#include <cmath>

#include "engine/base/pose.hpp"

namespace verisim::ruler {

struct Divider {
  enum class Kind { plane, cylinder, cone, sphere };
  Kind kind = Kind::plane;
  Vector3d point = Vector3d::Zero();  ///< of the plane or axis; apex of a cone; centre of a sphere
  Vector3d axis = Vector3d::UnitZ();  ///< normal of a plane, out of the material; of a cone towards growing radius
  double radius = 0;                  ///< of cylinder and sphere
  double sine = 0, cosine = 1;        ///< of a cone's half angle
};

/// A divider near a point.
struct Local {
  double value;        ///< g(x)
  Vector3d gradient;   ///< unit, or zero where there is none
  double bend_radius;  ///< distance to the axis or centre, infinite for a plane: no second derivative is larger than
                       ///< 1/bend_radius (and acts across the axis alone), no third than 2/sqrt(3)/bend_radius^2
};

/// sqrt rounds alike everywhere; the C library's hypot need not.
[[nodiscard]] inline double hypotenuse(double a, double b) {
  return std::sqrt(a * a + b * b);
}

[[nodiscard]] Divider placed(const Divider& divider, const Pose& X);
[[nodiscard]] double value_at(const Divider& divider, const Vector3d& x);
[[nodiscard]] Local local_at(const Divider& divider, const Vector3d& x);

/// The second derivative of g along a and b at x. @pre local is local_at(divider, x)
[[nodiscard]] double bend(const Divider& divider, const Vector3d& x, const Local& local, const Vector3d& a,
                          const Vector3d& b);
/// The length of the part of a step that bends the divider: across the axis; of a sphere all of it, of a plane nothing.
[[nodiscard]] double across(const Divider& divider, const Vector3d& step);

/// Do both divide space alike (to 1e-11)? `opposite` tells whether their insides are each other's outsides.
[[nodiscard]] bool is_same(const Divider& a, const Divider& b, bool& opposite);

}  // namespace verisim::ruler
