// A surface that divides space in two: plane, cylinder, cone, sphere, torus. What the solids of the ruler are made of.
//
// Signed distance g(x) [m], negative inside (below the plane, within the radius). It is never larger than the distance
// to the surface, changes by at most 1 m per m, and has a unit gradient but on the axis, at the centre or on a torus'
// ring, where `bend_radius` is 0. Written for the ruler alone: it shares no code with engine/geometry.
#pragma once

#include <cmath>

#include "engine/base/pose.hpp"

namespace verisim::ruler {

struct Divider {
  enum class Kind { plane, cylinder, cone, sphere, torus };
  Kind kind = Kind::plane;
  Vector3d point = Vector3d::Zero();  ///< of the plane or axis; apex of a cone; centre of a sphere or torus
  Vector3d axis = Vector3d::UnitZ();  ///< normal of a plane, out of the material; of a cone towards growing radius
  double radius = 0;                  ///< of cylinder and sphere; of a torus' tube
  double ring = 0;                    ///< radius of the circle around which a torus' tube lies
  double sine = 0, cosine = 1;        ///< of a cone's half angle
};

/// A divider near a point.
struct Local {
  double value;        ///< g(x)
  Vector3d gradient;   ///< unit, or zero where there is none
  double bend_radius;  ///< distance to the axis, centre or ring, whichever is nearest; infinite for a plane: no second
                       ///< derivative is larger than 1/bend_radius (and acts along `across` alone), no third than
                       ///< third_factor/bend_radius^2
};

/// Of a distance to a point or line the third derivative along a unit way is -3 c (1 - c^2)/r^2 at most, with its
/// cosine c to the gradient: 2/sqrt(3). Of a torus, a distance of distances, the chain rule gives 2/sqrt(3) twice,
/// and 3.
[[nodiscard]] inline double third_factor(const Divider& divider) {
  constexpr double kOfDistance = 1.1548;
  return divider.kind == Divider::Kind::torus ? 2 * kOfDistance + 3 : kOfDistance;
}

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
/// The length of the part of a step that bends the divider: across the axis; of a sphere or torus all of it, of a plane
/// nothing.
[[nodiscard]] double across(const Divider& divider, const Vector3d& step);

/// Is the straight way between any two points that are not above it not above it either?
[[nodiscard]] inline bool is_convex_below(const Divider& divider) {
  return divider.kind != Divider::Kind::torus;
}

/// Do both divide space alike (to 1e-11)? `opposite` tells whether their insides are each other's outsides.
[[nodiscard]] bool is_same(const Divider& a, const Divider& b, bool& opposite);

}  // namespace verisim::ruler
