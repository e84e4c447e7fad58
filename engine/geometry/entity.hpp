// Boundary-representation entities of a part: its faces (on plane, cylinder, cone, sphere, torus, or another surface)
// and edges (on line, circle, ellipse, or another curve), each of its own type, with exact parameters.
//
// All in part coordinates [m, rad], right-handed. Directions and normals are unit. An entity knows its material's side:
// a plane's normal points out of the material; `hole` of a curved surface is true if its axis or centre lies outside of
// the material next to the face.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "engine/base/pose.hpp"

namespace verisim {

// --- surfaces -------------------------------------------------------------------------------------------------------
// Each is parametrized in right-handed local coordinates with the axes x_axis, y = direction x x_axis, direction.

struct Plane {
  Vector3d point;   ///< any point of the plane
  Vector3d normal;  ///< out of the material
  Vector3d x_axis;  ///< u = (p - point).x_axis, v = (p - point).(normal x x_axis) [m]
};

/// p(u, v) = point + radius (cos u x + sin u y) + v direction
struct Cylinder {
  Vector3d point;  ///< any point of the axis
  Vector3d direction;
  Vector3d x_axis;
  double radius;  ///< > 0
  bool hole;      ///< true: material is outside the radius
};

/// p(u, v) = point + (radius + v tan(half_angle)) (cos u x + sin u y) + v direction; v is measured ALONG THE AXIS.
struct Cone {
  Vector3d point;      ///< of the axis, where the radius is `radius`
  Vector3d direction;  ///< towards growing radius
  Vector3d x_axis;
  double radius;      ///< at `point`, >= 0
  double half_angle;  ///< in (0, pi/2)
  bool hole;
};

/// p(u, v) = center + radius (cos v (cos u x + sin u y) + sin v direction)
struct Sphere {
  Vector3d center;
  Vector3d direction;
  Vector3d x_axis;
  double radius;
  bool hole;
};

/// p(u, v) = center + (major + minor cos v) (cos u x + sin u y) + minor sin v direction
struct Torus {
  Vector3d center;
  Vector3d direction;
  Vector3d x_axis;
  double major_radius;
  double minor_radius;
  bool hole;  ///< true: the material is outside the tube
};

/// A surface of another kind (B-spline, extrusion …): known by its triangles only.
struct OtherSurface {};

using Surface = std::variant<Plane, Cylinder, Cone, Sphere, Torus, OtherSurface>;
inline constexpr std::array kSurfaceNames = {"plane", "cylinder", "cone", "sphere", "torus", "other"};
static_assert(kSurfaceNames.size() == std::variant_size_v<Surface>, "each kind of surface has a name");

// --- curves ---------------------------------------------------------------------------------------------------------

/// p(t) = point + t direction
struct Line {
  Vector3d point;
  Vector3d direction;
};

/// p(t) = center + radius (cos t x + sin t y)
struct Circle {
  Vector3d center;
  Vector3d normal;
  Vector3d x_axis;
  double radius;
};

/// p(t) = center + major cos t x + minor sin t y
struct Ellipse {
  Vector3d center;
  Vector3d normal;
  Vector3d x_axis;
  double major_radius;
  double minor_radius;
};

struct OtherCurve {};

using Curve = std::variant<Line, Circle, Ellipse, OtherCurve>;
inline constexpr std::array kCurveNames = {"line", "circle", "ellipse", "other"};
static_assert(kCurveNames.size() == std::variant_size_v<Curve>, "each kind of curve has a name");

// --- topology -------------------------------------------------------------------------------------------------------

struct Face {
  Surface surface;
  std::array<double, 2> u_range = {0, 0};  ///< trimmed bounds in the surface's parameters (see above)
  std::array<double, 2> v_range = {0, 0};
  double area = 0;                   ///< exact, m^2
  std::vector<std::uint32_t> edges;  ///< indices of its bounding edges in the part
};

struct Edge {
  Curve curve;
  std::array<double, 2> t_range = {0, 0};  ///< trimmed bounds in the curve's parameter
  double length = 0;                       ///< m
  std::vector<Vector3d> polyline;          ///< points along the edge, those of the tessellation
  std::vector<std::uint32_t> faces;  ///< the two faces that it bounds; one: a seam, where a curved face meets itself
};

}  // namespace verisim
