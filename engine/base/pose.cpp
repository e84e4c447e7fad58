#include "engine/base/pose.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "engine/base/pinned_math.hpp"

namespace verisim {

Quaterniond turn_between(const Vector3d& a, const Vector3d& b) {
  constexpr double kOpposite = 1e-12;
  const Vector3d from = a.normalized(), to = b.normalized();
  const double cosine = to.dot(from);
  if (cosine < -1 + kOpposite) {
    const Vector3d across = from.unitOrthogonal();
    return Quaterniond(0, across.x(), across.y(), across.z());
  }
  const Vector3d axis = from.cross(to);
  const double s = std::sqrt((1 + cosine) * 2);
  const double inverse = 1 / s;
  return Quaterniond(s * 0.5, axis.x() * inverse, axis.y() * inverse, axis.z() * inverse);
}

Quaterniond rotation_from_vector(const Vector3d& w) {
  const double angle = std::sqrt(w.squaredNorm());
  // sin(a/2)/a by its series below 1e-4: the next term is a^4/3840, under 3e-20.
  const double s = angle < 1e-4 ? 0.5 - angle * angle / 48 : pinned::sin(angle / 2) / angle;
  return Quaterniond(pinned::cos(angle / 2), s * w.x(), s * w.y(), s * w.z()).normalized();
}

Vector3d vector_from_rotation(const Quaterniond& q) {
  const Vector3d v = q.w() < 0 ? Vector3d(-q.vec()) : Vector3d(q.vec());
  const double sine = std::sqrt(v.squaredNorm());
  const double cosine = std::abs(q.w());
  // 2 asin(s)/s = 2 + s^2/3 + ...; the next term is 3 s^4/20, under 2e-17 below 1e-4.
  const double scale = sine < 1e-4 ? 2 + sine * sine / 3 : 2 * pinned::atan2(sine, cosine) / sine;
  return scale * v;
}

Quaterniond slerp(const Quaterniond& a, const Quaterniond& b, double s) {
  return (a * rotation_from_vector(s * vector_from_rotation(a.conjugate() * b))).normalized();
}

Matrix3d skew(const Vector3d& w) {
  Matrix3d m;
  m << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  return m;
}

}  // namespace verisim
