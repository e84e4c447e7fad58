#include "engine/geometry/recover/surface_value.hpp"

#include <cmath>
#include <limits>

#include "engine/base/pinned_math.hpp"

namespace verisim::recover {

namespace {

constexpr double kTiny = 1e-300;

struct ValueOf {
  using Result = std::optional<SurfaceValue>;
  Result operator()(const Plane& s) const { return SurfaceValue{Kind::plane, s.point, s.normal}; }
  Result operator()(const Cylinder& s) const { return SurfaceValue{Kind::cylinder, s.point, s.direction, s.radius}; }
  Result operator()(const Cone& s) const {
    return SurfaceValue{Kind::cone, s.point, s.direction, s.radius, pinned::tan(s.half_angle)};
  }
  Result operator()(const Sphere& s) const { return SurfaceValue{Kind::sphere, s.center, s.direction, s.radius}; }
  Result operator()(const Torus& s) const {
    return SurfaceValue{Kind::torus, s.center, s.direction, s.major_radius, s.minor_radius};
  }
  Result operator()(const OtherSurface& /*s*/) const { return std::nullopt; }
};

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
  const Vector3d arm = p - point;
  const double height = arm.dot(axis);
  const Vector3d across = arm - height * axis;
  const double rho = across.norm();
  return {rho, height, rho > 0 ? Vector3d(across / rho) : Vector3d(axis.unitOrthogonal())};
}

std::optional<SurfaceValue> SurfaceValue::of(const Surface& surface) {
  return std::visit(ValueOf{}, surface);
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

double SurfaceValue::row(const Vector3d& p, const Vector3d& x, const Vector3d& y, Row& d) const {
  d.setZero();
  if (kind == Kind::sphere) {
    const Vector3d arm = p - point;
    const double r = arm.norm();
    d.head<3>() = -arm / std::max(r, kTiny);
    d[5] = -1;
    return r - a;
  }
  const Profile f = profile_of(p, point, axis);
  double by_rho = 1, by_height = 0, distance = 0;
  if (kind == Kind::plane) {
    distance = f.height;
    by_rho = 0, by_height = 1;
  } else if (kind == Kind::cylinder) {
    distance = f.rho - a;
    d[5] = -1;
  } else if (kind == Kind::cone) {
    const double cosine = 1 / std::sqrt(1 + b * b);
    distance = (f.rho - a - f.height * b) * cosine;
    by_rho = cosine, by_height = -b * cosine;
    d[5] = -cosine, d[6] = -f.height * cosine;
  } else {
    const double out = f.rho - a, r = std::max(std::sqrt(out * out + f.height * f.height), kTiny);
    distance = r - b;
    by_rho = out / r, by_height = f.height / r;
    d[5] = -by_rho, d[6] = -1;
  }
  d.head<3>() = -by_rho * f.outward - by_height * axis;
  const double tilt = by_height * f.rho - by_rho * f.height;
  d[3] = tilt * f.outward.dot(x), d[4] = tilt * f.outward.dot(y);
  return distance;
}

// The distance moves against the point as it moves with p.
Vector3d SurfaceValue::gradient(const Vector3d& p) const {
  Row d;
  static_cast<void>(row(p, Vector3d::Zero(), Vector3d::Zero(), d));
  return -d.head<3>();
}

double SurfaceValue::distance(const Vector3d& p) const {
  Row ignored;
  return row(p, Vector3d::Zero(), Vector3d::Zero(), ignored);
}

double SurfaceValue::radius_near(const Vector3d& p) const {
  switch (kind) {
    case Kind::plane:
      return std::numeric_limits<double>::infinity();
    case Kind::cone:
      return profile_of(p, point, axis).rho * std::sqrt(1 + b * b);
    case Kind::torus:
      return std::min(b, std::max(profile_of(p, point, axis).rho, kTiny));
    default:
      return a;
  }
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
