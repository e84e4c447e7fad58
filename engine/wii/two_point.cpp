#include "engine/wii/two_point.hpp"

#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim::wii {
TwoPointPose solve_two_points(const LedPair& leds, const Vector3d& ray0_R, const Vector3d& ray1_R, const Matrix3d& C_LR,
                              double forward_min) {
  VERISIM_ASSERT(ray0_R.z() == 1);
  VERISIM_ASSERT(ray1_R.z() == 1);
  VERISIM_ASSERT(!(leds.p0_H - leds.p1_H).head<2>().isZero(0));
  TwoPointPose result;
  const Vector3d q0 = C_LR * ray0_R;
  const Vector3d q1 = C_LR * ray1_R;
  if (q0.z() < forward_min || q1.z() < forward_min) return result;

  // The z row of the equation gives Z1 = (Z0 q0z - dz) / q1z, its x and y rows |Z0 A + B| = |d_xy|: a quadratic in Z0.
  const Vector3d d = leds.p0_H - leds.p1_H;
  const double ratio = q0.z() / q1.z();
  const Eigen::Vector2d A = q0.head<2>() - ratio * q1.head<2>();
  const Eigen::Vector2d B = d.z() / q1.z() * q1.head<2>();
  const double across = d.head<2>().squaredNorm();
  const double a = A.squaredNorm();
  const double b = A.dot(B);
  const double discriminant = b * b - a * (B.squaredNorm() - across);
  if (!(a > 0) || !(discriminant >= 0)) return result;
  result.depth = (std::sqrt(discriminant) - b) / a;
  if (!(result.depth > 0)) return result;

  const Eigen::Vector2d e = result.depth * A + B;  // = Rz(roll) d, its x and y
  result.cos_roll = (d.x() * e.x() + d.y() * e.y()) / across;
  result.sin_roll = (d.x() * e.y() - d.y() * e.x()) / across;
  const Vector3d& p = leds.p0_H;
  result.p_L = result.depth * q0 - Vector3d{result.cos_roll * p.x() - result.sin_roll * p.y(),
                                            result.sin_roll * p.x() + result.cos_roll * p.y(), p.z()};
  result.found = true;
  return result;
}

Quaterniond rotation_about_z(double cos_angle, double sin_angle) {
  VERISIM_ASSERT(std::abs(cos_angle * cos_angle + sin_angle * sin_angle - 1) < kUnitTolerance);
  // Half angles by square roots; the larger half first, so that neither loses digits.
  if (cos_angle >= 0) {
    const double w = std::sqrt((1 + cos_angle) / 2);
    return {w, 0, 0, sin_angle / (2 * w)};
  }
  const double z = std::copysign(std::sqrt((1 - cos_angle) / 2), sin_angle);
  return {sin_angle / (2 * z), 0, 0, z};
}

}  // namespace verisim::wii
