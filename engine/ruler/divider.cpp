#include "engine/ruler/divider.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace verisim::ruler {
namespace {

/// A point seen from an axis: along it, across it.
struct Meridian {
  double along, rho;
  Vector3d outward;  ///< unit, or zero on the axis
};

Meridian meridian_of(const Divider& d, const Vector3d& x) {
  const Vector3d from = x - d.point;
  const double along = d.axis.dot(from);
  const Vector3d radial = from - along * d.axis;
  const double rho = radial.norm();
  return {along, rho, rho > 0 ? Vector3d(radial / rho) : Vector3d(Vector3d::Zero())};
}

/// Lengths [m] and components of unit vectors that roundings alone keep apart.
constexpr double kSame = 1e-11;

bool is_same_line(const Divider& a, const Divider& b) {
  const Vector3d from = b.point - a.point;
  return a.axis.cross(b.axis).norm() < kSame && (from - a.axis.dot(from) * a.axis).norm() < kSame;
}

}  // namespace

Divider placed(const Divider& divider, const Pose& X) {
  Divider result = divider;
  result.point = X * divider.point;
  result.axis = X.rotation * divider.axis;
  return result;
}

double value_at(const Divider& d, const Vector3d& x) {
  switch (d.kind) {
    case Divider::Kind::plane:
      return d.axis.dot(x - d.point);
    case Divider::Kind::sphere:
      return (x - d.point).norm() - d.radius;
    case Divider::Kind::cylinder:
      return meridian_of(d, x).rho - d.radius;
    case Divider::Kind::cone: {
      const Meridian m = meridian_of(d, x);
      return m.rho * d.cosine - m.along * d.sine;
    }
    case Divider::Kind::torus: {
      const Meridian m = meridian_of(d, x);
      return hypotenuse(m.rho - d.ring, m.along) - d.radius;
    }
  }
  return 0;
}

Local local_at(const Divider& d, const Vector3d& x) {
  switch (d.kind) {
    case Divider::Kind::plane:
      return {d.axis.dot(x - d.point), d.axis, std::numeric_limits<double>::infinity()};
    case Divider::Kind::sphere: {
      const Vector3d from = x - d.point;
      const double length = from.norm();
      return {length - d.radius, length > 0 ? Vector3d(from / length) : Vector3d(Vector3d::Zero()), length};
    }
    case Divider::Kind::cylinder: {
      const Meridian m = meridian_of(d, x);
      return {m.rho - d.radius, m.outward, m.rho};
    }
    case Divider::Kind::cone: {
      const Meridian m = meridian_of(d, x);
      return {m.rho * d.cosine - m.along * d.sine, d.cosine * m.outward - d.sine * d.axis, m.rho};
    }
    case Divider::Kind::torus: {
      const Meridian m = meridian_of(d, x);
      const double across = m.rho - d.ring, far = hypotenuse(across, m.along);
      const Vector3d gradient =
          far > 0 ? Vector3d((across * m.outward + m.along * d.axis) / far) : Vector3d(Vector3d::Zero());
      return {far - d.radius, gradient, std::min(far, m.rho)};
    }
  }
  return {};
}

double bend(const Divider& d, const Vector3d& x, const Local& local, const Vector3d& a, const Vector3d& b) {
  switch (d.kind) {
    case Divider::Kind::plane:
      return 0;
    case Divider::Kind::sphere:
      return (a.dot(b) - local.gradient.dot(a) * local.gradient.dot(b)) / local.bend_radius;
    case Divider::Kind::cylinder:
    case Divider::Kind::cone: {
      const Vector3d around = d.axis.cross(meridian_of(d, x).outward);
      return (d.kind == Divider::Kind::cone ? d.cosine : 1) * around.dot(a) * around.dot(b) / local.bend_radius;
    }
    case Divider::Kind::torus: {
      const Meridian m = meridian_of(d, x);
      const Vector3d around = d.axis.cross(m.outward), along = local.gradient.cross(around);
      return along.dot(a) * along.dot(b) / (local.value + d.radius) +
             local.gradient.dot(m.outward) * around.dot(a) * around.dot(b) / m.rho;
    }
  }
  return 0;
}

double across(const Divider& d, const Vector3d& step) {
  if (d.kind == Divider::Kind::plane) return 0;
  if (d.kind == Divider::Kind::sphere || d.kind == Divider::Kind::torus) return step.norm();
  return (step - d.axis.dot(step) * d.axis).norm();
}

bool is_same(const Divider& a, const Divider& b, bool& opposite) {
  opposite = false;
  if (a.kind != b.kind) return false;
  switch (a.kind) {
    case Divider::Kind::plane:
      opposite = a.axis.dot(b.axis) < 0;
      return a.axis.cross(b.axis).norm() < kSame && std::abs(a.axis.dot(b.point - a.point)) < kSame;
    case Divider::Kind::sphere:
      return std::abs(a.radius - b.radius) < kSame && (a.point - b.point).norm() < kSame;
    case Divider::Kind::cylinder:
      return std::abs(a.radius - b.radius) < kSame && is_same_line(a, b);
    case Divider::Kind::cone:
      return std::abs(a.sine - b.sine) < kSame && (a.point - b.point).norm() < kSame &&
             (a.axis - b.axis).norm() < kSame;
    case Divider::Kind::torus:
      return std::abs(a.radius - b.radius) < kSame && std::abs(a.ring - b.ring) < kSame &&
             a.axis.cross(b.axis).norm() < kSame && (a.point - b.point).norm() < kSame;
  }
  return false;
}

}  // namespace verisim::ruler
