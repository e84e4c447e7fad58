#include "engine/geometry/recover/surface_value.hpp"

#include <cmath>

#include "engine/base/pinned_math.hpp"

namespace verisim::recover {

namespace {

Cone cone_of(const SurfaceValue& s) {
  Cone cone;
  cone.direction = s.b < 0 ? Vector3d(-s.axis) : s.axis;
  cone.x_axis = cone.direction.unitOrthogonal();
  cone.half_angle = pinned::atan2(std::abs(s.b), 1);
  cone.point = s.point;
  cone.radius = s.a;
  cone.hole = false;
  if (s.a < 0) {  // beyond the apex: seen from the apex
    cone.point -= s.a / std::abs(s.b) * cone.direction;
    cone.radius = 0;
  }
  return cone;
}

}  // namespace

Profile profile_of(const Vector3d& p, const Vector3d& point, const Vector3d& axis) {
  return verisim::profile_of(p, point, axis, [&] { return Vector3d(axis.unitOrthogonal()); });
}

std::optional<SurfaceValue> SurfaceValue::of(const Surface& surface) {
  const std::optional<AnalyticSurface> known = AnalyticSurface::from(surface);
  if (!known) return std::nullopt;
  const Meridian& m = known->meridian();
  const bool is_torus = m.kind == Kind::torus;
  return SurfaceValue{m.kind, known->point(), known->axis(), is_torus ? m.ring : m.radius,
                      is_torus ? m.radius : m.tangent};
}

Surface SurfaceValue::surface() const {
  const Vector3d x = axis.unitOrthogonal();
  switch (kind) {
    case Kind::plane:
      return Plane{point, axis, x};
    case Kind::cylinder:
      return Cylinder{point, axis, x, a, false};
    case Kind::cone:
      return cone_of(*this);
    case Kind::sphere:
      return Sphere{point, axis, x, a, false};
    case Kind::torus:
      return Torus{point, axis, x, std::abs(a), b, false};
  }
  return OtherSurface{};
}

Meridian SurfaceValue::meridian() const {
  switch (kind) {
    case Kind::plane:
      return {};
    case Kind::cylinder:
    case Kind::sphere:
      return {.kind = kind, .radius = a};
    case Kind::cone: {
      const double cosine = 1 / std::sqrt(1 + b * b);
      return {.kind = kind, .radius = a, .cosine = cosine, .sine = b * cosine, .tangent = b};
    }
    case Kind::torus:
      break;
  }
  return {.kind = Kind::torus, .radius = b, .ring = a};
}

double SurfaceValue::row(const Vector3d& p, const Vector3d& x, const Vector3d& y, Row& d) const {
  const Profile f = profile_of(p, point, axis);
  const Meridian m = meridian();
  const MeridianAt at = m.at(f.rho, f.height);
  const double by_rho = at.out / at.length, by_height = at.up / at.length;
  d.head<3>() = -by_rho * f.outward - by_height * axis;  // against the point as with p
  const double tilt = kind == Kind::sphere ? 0 : by_height * f.rho - by_rho * f.height;
  d[3] = tilt * f.outward.dot(x), d[4] = tilt * f.outward.dot(y);
  d.tail<2>().setZero();
  switch (kind) {
    case Kind::plane:
      break;
    case Kind::cylinder:
    case Kind::sphere:
      d[5] = -1;
      break;
    case Kind::cone:
      d[5] = -m.cosine, d[6] = -f.height * m.cosine;
      break;
    case Kind::torus:
      d[5] = -by_rho, d[6] = -1;
      break;
  }
  return at.distance;
}

Vector3d SurfaceValue::gradient(const Vector3d& p) const {
  const Profile f = profile_of(p, point, axis);
  const MeridianAt at = meridian().at(f.rho, f.height);
  return at.out / at.length * f.outward + at.up / at.length * axis;
}

double SurfaceValue::distance(const Vector3d& p) const {
  const Profile f = profile_of(p, point, axis);
  return meridian().distance(f.rho, f.height);
}

SurfaceValue SurfaceValue::moved(const Row& step, const Vector3d& x, const Vector3d& y) const {
  SurfaceValue result = *this;
  result.point += step.head<3>();
  result.axis = (axis + step[3] * x + step[4] * y).normalized();
  result.a += step[5];
  result.b += step[6];
  return result;
}

}  // namespace verisim::recover
