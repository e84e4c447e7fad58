#include "engine/wii/two_led_covariance.hpp"

#include <cmath>

#include "engine/base/error.hpp"

namespace verisim::wii {

Matrix6d two_led_covariance(const TrackerSettings& settings, const Pinhole& pinhole, double spacing,
                            const Vector3d& p_L, double cos_roll, double sin_roll) {
  VERISIM_ASSERT(spacing > 0);
  const double pixel = settings.pixel_sigma / std::min(pinhole.fx, pinhole.fy);
  const double pixel_square = pixel * pixel;
  const double tilt_square = settings.gravity_sigma * settings.gravity_sigma;
  const double yaw_square = settings.yaw_sigma * settings.yaw_sigma;
  const double range_square = p_L.squaredNorm();

  const double bearing = (p_L.x() * cos_roll + p_L.y() * sin_roll) / std::max(p_L.z(), kDegree);
  const double along = 2 * pixel_square * range_square / (spacing * spacing)               // relative variance of depth
                       + bearing * bearing * yaw_square + 0.75 * yaw_square * yaw_square;  // E[psi^4] = 3 sigma^4
  const double across = range_square * pixel_square / 2 + range_square * tilt_square;

  Matrix6d covariance = Matrix6d::Zero();
  covariance.topLeftCorner<3, 3>() = (along - tilt_square) * p_L * p_L.transpose();
  covariance.topLeftCorner<3, 3>().diagonal().array() += across;
  covariance(3, 3) = settings.pitch_sigma * settings.pitch_sigma + tilt_square;
  covariance(4, 4) = yaw_square + tilt_square;
  covariance(5, 5) = 2 * pixel_square * range_square / (spacing * spacing) + tilt_square;
  return covariance;
}

}  // namespace verisim::wii
