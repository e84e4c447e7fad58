#include "engine/exact/precise_surface.hpp"

#include <cmath>

#include "engine/base/pinned_math.hpp"

namespace verisim::exact {

double turn_of(double x, double y) {
  const double sum = std::abs(x) + std::abs(y);
  if (sum == 0) return 0;
  const double quarter = y / sum;
  if (x < 0) return 2 - quarter;
  return y < 0 ? 4 + quarter : quarter;
}

std::optional<PreciseSurface> PreciseSurface::from(const Surface& surface) {
  PreciseSurface s;
  const auto place = [&](Kind kind, const Vector3d& point, const Vector3d& axis, const Vector3d& x_axis) {
    s.kind_ = kind;
    s.point_ = point;
    s.axis_ = axis;
    s.x_axis_ = x_axis;
    s.y_axis_ = axis.cross(x_axis);
  };
  const auto round = [&](const auto& r, Kind kind, const Vector3d& point, double radius) {
    place(kind, point, r.direction, r.x_axis);
    s.radius_ = radius;
    s.side_ = r.hole ? -1 : 1;
  };
  if (const auto* plane = std::get_if<Plane>(&surface)) {
    place(Kind::plane, plane->point, plane->normal, plane->x_axis);
    s.radius_ = 1;  // has extent
  } else if (const auto* cylinder = std::get_if<Cylinder>(&surface)) {
    round(*cylinder, Kind::cylinder, cylinder->point, cylinder->radius);
  } else if (const auto* cone = std::get_if<Cone>(&surface)) {
    round(*cone, Kind::cone, cone->point, cone->radius);
    s.cosine_ = pinned::cos(cone->half_angle);
    s.sine_ = pinned::sin(cone->half_angle);
    s.tangent_ = s.sine_ / s.cosine_;
    if (!(s.tangent_ > 0)) return std::nullopt;
  } else if (const auto* sphere = std::get_if<Sphere>(&surface)) {
    round(*sphere, Kind::sphere, sphere->center, sphere->radius);
  } else if (const auto* torus = std::get_if<Torus>(&surface)) {
    round(*torus, Kind::torus, torus->center, torus->minor_radius);
    s.ring_ = torus->major_radius;
  } else {
    return std::nullopt;
  }
  const bool has_extent = s.kind_ == Kind::cone ? s.radius_ >= 0 : s.radius_ > 0;
  const double sum = s.radius_ + s.ring_ + s.tangent_ + s.point_.sum() + s.axis_.sum() + s.x_axis_.sum();
  if (!has_extent || !std::isfinite(sum)) return std::nullopt;
  return s;
}

std::array<double, 2> PreciseSurface::chart(const Vector3d& foot) const {
  const Vector3d d = foot - point_;
  const double x = d.dot(x_axis_);
  const double y = d.dot(y_axis_);
  const double height = d.dot(axis_);
  switch (kind_) {
    case Kind::plane:
      return {x, y};
    case Kind::sphere:
      return {turn_of(x, y), height / radius_};
    case Kind::torus:
      return {turn_of(x, y), turn_of(std::sqrt(x * x + y * y) - ring_, height)};
    default:
      return {turn_of(x, y), height};
  }
}

}  // namespace verisim::exact
