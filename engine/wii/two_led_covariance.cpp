#include "engine/wii/two_led_covariance.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "engine/base/contract.hpp"

namespace verisim::wii {
namespace {

constexpr double kNearest = 0.05;  // m: no head is nearer (admission.hpp)

}  // namespace

Matrix6d two_led_covariance(const TrackerSettings& settings, const Pinhole& pinhole, const Vector3d& p_L,
                            double cos_roll, double sin_roll) {
  VERISIM_ASSERT(is_finite(p_L));
  const Vector3d head_x(cos_roll, sin_roll, 0);
  const Vector3d head_y(-sin_roll, cos_roll, 0);
  Eigen::Matrix4d seen;                // P_i (dp, droll)
  Eigen::Matrix<double, 4, 2> turned;  // P_i d_i of a yaw and of a pitch
  Eigen::Vector4d depth;
  for (Eigen::Index i = 0; i < 2; ++i) {
    const Vector3d& p_H = settings.leds.p_H[static_cast<std::size_t>(i)];
    const Vector3d arm = p_H.x() * head_x + p_H.y() * head_y + p_H.z() * Vector3d::UnitZ();
    const Vector3d p = p_L + arm;
    depth.segment<2>(2 * i).setConstant(std::max(p.z(), kNearest));
    Eigen::Matrix<double, 2, 3> P;
    P << 1, 0, -p.x() / depth[2 * i], 0, 1, -p.y() / depth[2 * i];
    seen.block<2, 3>(2 * i, 0) = P;
    seen.block<2, 1>(2 * i, 3) = P * Vector3d::UnitZ().cross(arm);
    turned.block<2, 1>(2 * i, 0) = P * head_y.cross(arm);
    turned.block<2, 1>(2 * i, 1) = P * head_x.cross(arm);
  }
  const Eigen::Matrix4d inverse = seen.inverse();
  const double pixel = settings.pixel_sigma / std::min(pinhole.fx, pinhole.fy);
  const Eigen::Matrix4d noise = inverse * (pixel * depth).asDiagonal();
  const Eigen::Matrix<double, 4, 2> unseen = inverse * turned;

  // What the estimate shows of a turn, less the turn itself, which it takes for zero.
  Eigen::Matrix<double, 6, 2> off = Eigen::Matrix<double, 6, 2>::Zero();
  off.topRows<3>() = unseen.topRows<3>();
  off.row(5) = unseen.row(3);
  off.block<3, 1>(3, 0) -= head_y;
  off.block<3, 1>(3, 1) -= head_x;
  const double yaw_square = settings.yaw_sigma * settings.yaw_sigma;
  const double pitch_square = settings.pitch_sigma * settings.pitch_sigma;

  Eigen::Matrix<double, 6, 4> noise_in_pose = Eigen::Matrix<double, 6, 4>::Zero();
  noise_in_pose.topRows<3>() = noise.topRows<3>();
  noise_in_pose.row(5) = noise.row(3);
  Matrix6d covariance = noise_in_pose * noise_in_pose.transpose();
  covariance += yaw_square * off.col(0) * off.col(0).transpose() + pitch_square * off.col(1) * off.col(1).transpose();
  add_second_order(covariance, p_L, settings.yaw_sigma, settings.pitch_sigma);
  return covariance;
}

void add_second_order(Matrix6d& covariance, const Vector3d& p_L, double yaw_sigma, double pitch_sigma) {
  const double yaw_square = yaw_sigma * yaw_sigma;
  covariance.topLeftCorner<3, 3>() +=
      0.75 * yaw_square * yaw_square * p_L * p_L.transpose();  // a quarter of E[psi^4] = 3 sigma^4
  covariance(5, 5) += yaw_square * pitch_sigma * pitch_sigma / 4;
}

}  // namespace verisim::wii
