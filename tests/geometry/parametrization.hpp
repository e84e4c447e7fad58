// The formulas of entity.hpp, written once more: the tests hold the kernel's answers against them.
#pragma once

#include <cmath>
#include <optional>

#include "engine/geometry/entity.hpp"

namespace verisim::testing {

struct SurfacePoint {
  double u = 0;
  double v = 0;
  double distance = 0;   ///< of the point from the surface [m]
  Vector3d outward;      ///< out of the material
  bool on_axis = false;  ///< u means nothing
};

struct LocalPoint {
  double x = 0;
  double y = 0;
  double z = 0;
};

inline LocalPoint local(const Vector3d& p, const Vector3d& origin, const Vector3d& direction, const Vector3d& x_axis) {
  const Vector3d d = p - origin;
  return {d.dot(x_axis), d.dot(direction.cross(x_axis)), d.dot(direction)};
}

inline Vector3d radial(const LocalPoint& q, const Vector3d& direction, const Vector3d& x_axis) {
  const double r = std::hypot(q.x, q.y);
  return r == 0 ? Vector3d::Zero() : Vector3d((q.x * x_axis + q.y * direction.cross(x_axis)) / r);
}

inline std::optional<SurfacePoint> project_off_axis(const Surface& surface, const Vector3d& p) {
  if (const auto* s = std::get_if<Plane>(&surface)) {
    const LocalPoint q = local(p, s->point, s->normal, s->x_axis);
    return SurfacePoint{q.x, q.y, q.z, s->normal};
  }
  if (const auto* s = std::get_if<Cylinder>(&surface)) {
    const LocalPoint q = local(p, s->point, s->direction, s->x_axis);
    const double sign = s->hole ? -1 : 1;
    return SurfacePoint{std::atan2(q.y, q.x), q.z, std::hypot(q.x, q.y) - s->radius,
                        sign * radial(q, s->direction, s->x_axis)};
  }
  if (const auto* s = std::get_if<Cone>(&surface)) {
    const LocalPoint q = local(p, s->point, s->direction, s->x_axis);
    const double sign = s->hole ? -1 : 1;
    const double along = std::hypot(q.x, q.y) - s->radius - q.z * std::tan(s->half_angle);
    const Vector3d outward =
        std::cos(s->half_angle) * radial(q, s->direction, s->x_axis) - std::sin(s->half_angle) * s->direction;
    return SurfacePoint{std::atan2(q.y, q.x), q.z, along * std::cos(s->half_angle), sign * outward};
  }
  if (const auto* s = std::get_if<Sphere>(&surface)) {
    const LocalPoint q = local(p, s->center, s->direction, s->x_axis);
    const double sign = s->hole ? -1 : 1;
    return SurfacePoint{std::atan2(q.y, q.x), std::atan2(q.z, std::hypot(q.x, q.y)), (p - s->center).norm() - s->radius,
                        sign * (p - s->center).normalized()};
  }
  if (const auto* s = std::get_if<Torus>(&surface)) {
    const LocalPoint q = local(p, s->center, s->direction, s->x_axis);
    const Vector3d out = radial(q, s->direction, s->x_axis);
    // A tube wider than its ring passes the axis: the point may belong to the tube on the other side.
    const auto distance = [&](double side) {
      return (p - s->center - side * s->major_radius * out).norm() - s->minor_radius;
    };
    const double side = std::abs(distance(1)) <= std::abs(distance(-1)) ? 1 : -1;
    const Vector3d ring = s->center + side * s->major_radius * out;
    const double v = std::atan2(q.z, side * std::hypot(q.x, q.y) - s->major_radius);
    const double sign = s->hole ? -1 : 1;
    return SurfacePoint{std::atan2(side * q.y, side * q.x), v, distance(side), sign * (p - ring).normalized()};
  }
  return std::nullopt;
}

/// Where `p` lies on the surface; nothing for other surfaces.
inline std::optional<SurfacePoint> project(const Surface& surface, const Vector3d& p) {
  std::optional<SurfacePoint> on = project_off_axis(surface, p);
  const auto distance_from_axis = [&](const auto& s) -> double {
    if constexpr (requires { s.center; }) return (p - s.center).cross(s.direction).norm();
    if constexpr (requires { s.half_angle; }) return (p - s.point).cross(s.direction).norm();
    return 1;
  };
  if (on) on->on_axis = std::visit(distance_from_axis, surface) < 1e-7;
  return on;
}

/// The point at t of a curve; nothing for other curves.
inline std::optional<Vector3d> point_at(const Curve& curve, double t) {
  const auto around = [&](const Vector3d& center, const Vector3d& normal, const Vector3d& x, double a,
                          double b) -> Vector3d {
    return center + a * std::cos(t) * x + b * std::sin(t) * normal.cross(x);
  };
  if (const auto* c = std::get_if<Line>(&curve)) return Vector3d(c->point + t * c->direction);
  if (const auto* c = std::get_if<Circle>(&curve)) return around(c->center, c->normal, c->x_axis, c->radius, c->radius);
  if (const auto* c = std::get_if<Ellipse>(&curve))
    return around(c->center, c->normal, c->x_axis, c->major_radius, c->minor_radius);
  return std::nullopt;
}

/// Is the angle within the range, whatever the number of turns, to `slack` rad?
inline bool angle_within(double angle, const std::array<double, 2>& range, double slack) {
  constexpr double kTurn = 2 * 3.14159265358979323846;
  for (int turns = -2; turns <= 2; ++turns) {
    const double a = angle + turns * kTurn;
    if (a >= range[0] - slack && a <= range[1] + slack) return true;
  }
  return false;
}

}  // namespace verisim::testing
