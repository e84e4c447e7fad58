#include "engine/wii/head_filter.hpp"

#include <cmath>

#include "engine/wii/admission.hpp"

namespace verisim::wii {
namespace {

// Chosen on the natural trajectory: lower lags behind it, higher lets pixel noise through.
constexpr double kLinearDensity = 0.15;  // m^2/s^3
constexpr double kAngularDensity = 2;    // rad^2/s^3
constexpr double kUnseenDensity = 8;     // times as much once nothing is seen: the head may do anything
constexpr double kDecay = 0.25;          // s
constexpr double kSpinMax = 15;          // rad/s

}  // namespace

void HeadFilter::start(const Pose& X_RH, const Matrix6d& covariance) {
  X_RH_ = X_RH;
  R_RH_ = X_RH.rotation.toRotationMatrix();
  v_.setZero();
  w_.setZero();
  P_.setZero();
  P_.block<3, 3>(0, 0) = covariance.block<3, 3>(0, 0);
  P_.block<3, 3>(0, 6) = covariance.block<3, 3>(0, 3);
  P_.block<3, 3>(6, 0) = covariance.block<3, 3>(3, 0);
  P_.block<3, 3>(6, 6) = covariance.block<3, 3>(3, 3);
  P_.diagonal().segment<3>(3).setConstant(0.25);
  P_.diagonal().segment<3>(9).setConstant(1);
}

void HeadFilter::predict(double dt, bool seen) {
  X_RH_.position += dt * v_;
  turn(dt * w_);

  // P <- F P F^T with F = [1 dt; 0 1] for both pairs of blocks.
  P_.middleRows<3>(0) += dt * P_.middleRows<3>(3);
  P_.middleRows<3>(6) += dt * P_.middleRows<3>(9);
  P_.middleCols<3>(0) += dt * P_.middleCols<3>(3);
  P_.middleCols<3>(6) += dt * P_.middleCols<3>(9);
  if (!seen) {
    const double keep = kDecay / (kDecay + dt);
    v_ *= keep;
    w_ *= keep;
    for (const int block : {3, 9}) {
      P_.middleRows<3>(block) *= keep;
      P_.middleCols<3>(block) *= keep;
    }
  }
  const double more = seen ? 1 : kUnseenDensity;
  const auto drive = [&](int block, double density) {
    for (int i = block; i < block + 3; ++i) {
      P_(i, i) += density * dt * dt * dt / 3;
      P_(i, i + 3) += density * dt * dt / 2;
      P_(i + 3, i) += density * dt * dt / 2;
      P_(i + 3, i + 3) += density * dt;
    }
  };
  drive(0, more * kLinearDensity);
  drive(6, more * kAngularDensity);
}

bool HeadFilter::correct(const Vector3d& g_p, const Vector3d& g_theta, double residual, double variance, double gate) {
  const Vector12d Pg = P_.middleCols<3>(0) * g_p + P_.middleCols<3>(6) * g_theta;
  const double expected = g_p.dot(Pg.segment<3>(0)) + g_theta.dot(Pg.segment<3>(6)) + variance;
  if (!(residual * residual <= gate * gate * expected)) return false;
  const Vector12d gain = Pg / expected;
  P_.noalias() -= gain * Pg.transpose();
  X_RH_.position += residual * gain.segment<3>(0);
  v_ += residual * gain.segment<3>(3);
  turn(residual * gain.segment<3>(6));
  w_ += residual * gain.segment<3>(9);
  v_ *= std::min(1.0, kSpeedMax / std::max(v_.norm(), kSpeedMax));
  w_ *= std::min(1.0, kSpinMax / std::max(w_.norm(), kSpinMax));
  return true;
}

void HeadFilter::turn(const Vector3d& rotation) {
  // The half-angle tangent form: exact direction, angle to third order; steps are hundredths of a radian.
  const Vector3d half = rotation / 2;
  X_RH_.rotation = (Quaterniond(1, half.x(), half.y(), half.z()) * X_RH_.rotation).normalized();
  R_RH_ = X_RH_.rotation.toRotationMatrix();
}

Matrix6d HeadFilter::covariance() const {
  Matrix6d c;
  c.block<3, 3>(0, 0) = P_.block<3, 3>(0, 0);
  c.block<3, 3>(0, 3) = P_.block<3, 3>(0, 6);
  c.block<3, 3>(3, 0) = P_.block<3, 3>(6, 0);
  c.block<3, 3>(3, 3) = P_.block<3, 3>(6, 6);
  return c;
}

}  // namespace verisim::wii
