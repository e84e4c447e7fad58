#include "engine/geometry/analytic_surface.hpp"

#include <algorithm>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/overloaded.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/geometry/entity_check.hpp"

namespace verisim {

static_assert(std::variant_size_v<Surface> == static_cast<std::size_t>(SurfaceKind::torus) + 2,
              "every kind of surface but the other one has a SurfaceKind");

double turn_of(double x, double y) {
  const double sum = std::abs(x) + std::abs(y);
  if (sum == 0) return 0;
  const double quarter = y / sum;
  if (x < 0) return 2 - quarter;
  return y < 0 ? 4 + quarter : quarter;
}

double Meridian::apex() const {
  switch (kind) {
    case SurfaceKind::plane:
    case SurfaceKind::cylinder:
    case SurfaceKind::sphere:
      return 0;
    case SurfaceKind::cone:
      VERISIM_ASSERT(tangent != 0);
      return -radius / tangent;
    case SurfaceKind::torus:
      break;
  }
  return std::sqrt(std::max(radius * radius - ring * ring, 0.0));
}

double Meridian::parameter(double rho, double h) const {
  switch (kind) {
    case SurfaceKind::plane:
    case SurfaceKind::cylinder:
    case SurfaceKind::cone:
      return h;
    case SurfaceKind::sphere:
    case SurfaceKind::torus:
      break;
  }
  // On the inside of a tube wider than its ring a place belongs to the tube whose middle lies beyond the axis.
  return pinned::atan2(h, ring < 0 ? ring - rho : rho - ring);
}

std::optional<AnalyticSurface> AnalyticSurface::from(const Surface& surface) {
  if (fault_of(surface)) return std::nullopt;
  AnalyticSurface made;
  const auto place = [&](const Vector3d& point, const Vector3d& axis, const Vector3d& x_axis) {
    made.point_ = point;
    made.axis_ = axis;
    made.x_axis_ = x_axis;
    made.y_axis_ = axis.cross(x_axis);
  };
  const auto round = [&](const auto& s, const Vector3d& point, const Meridian& meridian) {
    place(point, s.direction, s.x_axis);
    made.meridian_ = meridian;
    made.side_ = s.hole ? -1 : 1;
    return true;
  };
  const bool has_equation = std::visit(
      Overloaded{
          [&](const Plane& s) {
            place(s.point, s.normal, s.x_axis);
            return true;
          },
          [&](const Cylinder& s) { return round(s, s.point, {.kind = SurfaceKind::cylinder, .radius = s.radius}); },
          [&](const Cone& s) {
            const double cosine = pinned::cos(s.half_angle), sine = pinned::sin(s.half_angle);
            return round(s, s.point,
                         {.kind = SurfaceKind::cone,
                          .radius = s.radius,
                          .cosine = cosine,
                          .sine = sine,
                          .tangent = sine / cosine});
          },
          [&](const Sphere& s) { return round(s, s.center, {.kind = SurfaceKind::sphere, .radius = s.radius}); },
          [&](const Torus& s) {
            return round(s, s.center, {.kind = SurfaceKind::torus, .radius = s.minor_radius, .ring = s.major_radius});
          },
          [](const OtherSurface&) { return false; }},
      surface);
  if (!has_equation) return std::nullopt;
  return made;
}

std::optional<AnalyticSurface> AnalyticSurface::from(const Face& face) {
  std::optional<AnalyticSurface> made = from(face.surface);
  if (!made || made->kind() != SurfaceKind::torus) return made;
  Meridian& m = made->meridian_;
  const double middle = 0.5 * (face.v_range[0] + face.v_range[1]);
  if (m.ring + m.radius * pinned::cos(middle) < 0) m.ring = -m.ring;
  return made;
}

AnalyticSurface AnalyticSurface::in_grid(const Vector3d& origin, double scale) const {
  VERISIM_ASSERT(is_finite(origin));
  VERISIM_ASSERT(is_positive(scale));
  AnalyticSurface moved = *this;
  moved.point_ = scale * (point_ - origin);
  moved.meridian_.radius *= scale;
  moved.meridian_.ring *= scale;
  return moved;
}

Vector3d AnalyticSurface::foot(const Vector3d& p) const {
  const Profile f = profile(p);
  const MeridianAt m = meridian_.at(f.rho, f.height);
  const double step = m.distance / m.length;
  const bool is_round = meridian_.kind != SurfaceKind::plane;
  if (is_round && f.rho - step * m.out < 0) {  // beyond the axis: where the surface meets it is nearer
    const bool is_below = meridian_.kind != SurfaceKind::cone && f.height < 0;
    return point_ + (is_below ? -meridian_.apex() : meridian_.apex()) * axis_;
  }
  return p - step * (m.out * f.outward + m.up * axis_);
}

double AnalyticSurface::curvature_bound(const Vector3d& p, double reach) const {
  const Profile f = profile(p);
  return meridian_.curvature_bound(f.rho, f.height, reach);
}

std::array<double, 2> AnalyticSurface::parameters(const Vector3d& p) const {
  const Vector3d own = to_own_axes(p - point_);
  if (meridian_.kind == SurfaceKind::plane) return {own.x(), own.y()};
  const double towards = meridian_.ring < 0 ? -1 : 1;  // the middle of the tube that the point belongs to
  return {pinned::atan2(towards * own.y(), towards * own.x()), meridian_.parameter(own.head<2>().norm(), own.z())};
}

std::array<double, 2> AnalyticSurface::chart(const Vector3d& foot) const {
  const Vector3d d = foot - point_;
  const double x = d.dot(x_axis_);
  const double y = d.dot(y_axis_);
  const double height = d.dot(axis_);
  switch (meridian_.kind) {
    case SurfaceKind::plane:
      return {x, y};
    case SurfaceKind::cylinder:
    case SurfaceKind::cone:
      return {turn_of(x, y), height};
    case SurfaceKind::sphere:
      return {turn_of(x, y), height / meridian_.radius};
    case SurfaceKind::torus:
      break;
  }
  return {turn_of(x, y), turn_of(std::sqrt(x * x + y * y) - meridian_.ring, height)};
}

}  // namespace verisim
