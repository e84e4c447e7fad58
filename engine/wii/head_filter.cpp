#include "engine/wii/head_filter.hpp"

#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/wii/admission.hpp"

namespace verisim::wii {
void HeadFilter::start(const Pose& X_RH, const Matrix6d& covariance) {
  VERISIM_ASSERT(is_placement(X_RH));
  VERISIM_ASSERT(covariance.allFinite());
  X_RH_ = X_RH;
  R_RH_ = X_RH.rotation.toRotationMatrix();
  v_.setZero();
  w_.setZero();
  v_slow_.setZero();
  w_slow_.setZero();
  view_ = View::all;
  P_.setZero();
  P_.block<3, 3>(0, 0) = covariance.block<3, 3>(0, 0);
  P_.block<3, 3>(0, 6) = covariance.block<3, 3>(0, 3);
  P_.block<3, 3>(6, 0) = covariance.block<3, 3>(3, 0);
  P_.block<3, 3>(6, 6) = covariance.block<3, 3>(3, 3);
  P_.diagonal().segment<3>(3).setConstant(thresholds_.start_speed * thresholds_.start_speed);
  P_.diagonal().segment<3>(9).setConstant(thresholds_.start_spin * thresholds_.start_spin);
}

void HeadFilter::predict(double dt, View view) {
  VERISIM_ASSERT(is_not_negative(dt));
  if (view == View::all) {
    v_slow_ += dt / (thresholds_.slow + dt) * (v_ - v_slow_);
    w_slow_ += dt / (thresholds_.slow + dt) * (w_ - w_slow_);
  } else if (view_ == View::all) {
    w_ = w_slow_;
    if (view != View::pair) v_ = v_slow_;
  }
  view_ = view;
  X_RH_.position += dt * v_;
  turn(dt * w_);

  // P <- F P F^T with F = [1 dt; 0 1] for both pairs of blocks.
  P_.middleRows<3>(0) += dt * P_.middleRows<3>(3);
  P_.middleRows<3>(6) += dt * P_.middleRows<3>(9);
  P_.middleCols<3>(0) += dt * P_.middleCols<3>(3);
  P_.middleCols<3>(6) += dt * P_.middleCols<3>(9);
  const double decay = view == View::pair ? thresholds_.pair_decay : thresholds_.decay;
  if (view != View::all) slow_down(decay / (decay + dt), view);
  const double more = view == View::none ? thresholds_.unseen_density : 1;
  const auto drive = [&](int block, double density) {
    for (int i = block; i < block + 3; ++i) {
      P_(i, i) += density * dt * dt * dt / 3;
      P_(i, i + 3) += density * dt * dt / 2;
      P_(i + 3, i) += density * dt * dt / 2;
      P_(i + 3, i + 3) += density * dt;
    }
  };
  drive(0, more * thresholds_.linear_density);
  const bool guessing = view == View::pair || view == View::one;
  drive(6, more * (guessing ? thresholds_.guessed_density : thresholds_.angular_density));
}

void HeadFilter::slow_down(double keep, View view) {
  w_ *= keep;
  P_.middleRows<3>(9) *= keep;
  P_.middleCols<3>(9) *= keep;
  if (view == View::pair) return;
  // One LED still shows motion across its ray. Damping that too would falsify it, and the depth that is made to explain
  // it.
  const Vector3d ray = X_RH_.position.normalized();
  const Matrix3d damp = view == View::none ? Matrix3d(keep * Matrix3d::Identity())
                                           : Matrix3d(Matrix3d::Identity() - (1 - keep) * ray * ray.transpose());
  v_ = damp * v_;
  P_.middleRows<3>(3) = (damp * P_.middleRows<3>(3)).eval();
  P_.middleCols<3>(3) = (P_.middleCols<3>(3) * damp).eval();
}

bool HeadFilter::correct(const Vector3d& g_p, const Vector3d& g_theta, double residual, double variance, double gate) {
  VERISIM_ASSERT(variance > 0);
  const Vector12d Pg = P_.middleCols<3>(0) * g_p + P_.middleCols<3>(6) * g_theta;
  const double expected = g_p.dot(Pg.segment<3>(0)) + g_theta.dot(Pg.segment<3>(6)) + variance;
  if (!(residual * residual <= gate * gate * expected)) return false;
  const Vector12d gain = Pg / expected;
  P_.noalias() -= gain * Pg.transpose();
  move(residual * gain);
  return true;
}

bool HeadFilter::correct_across(const Vector3d& g_p, const Vector3d& g_theta, double residual, double variance,
                                double gate) {
  VERISIM_ASSERT(variance > 0);
  const Vector12d Pg = P_.middleCols<3>(0) * g_p + P_.middleCols<3>(6) * g_theta;
  const double expected = g_p.dot(Pg.segment<3>(0)) + g_theta.dot(Pg.segment<3>(6)) + variance;
  if (!(residual * residual <= gate * gate * expected)) return false;
  Vector12d gain = Pg / expected;
  const Vector3d ray = X_RH_.position.normalized();
  for (const int block : {0, 3}) gain.segment<3>(block) -= ray * ray.dot(gain.segment<3>(block));
  for (const int block : {6, 9}) gain.segment<3>(block).setZero();
  // The covariance that any gain leaves, not only the best one (Joseph's form, written out).
  P_ += expected * gain * gain.transpose() - gain * Pg.transpose() - Pg * gain.transpose();
  move(residual * gain);
  return true;
}

void HeadFilter::move(const Vector12d& error) {
  X_RH_.position += error.segment<3>(0);
  v_ += error.segment<3>(3);
  turn(error.segment<3>(6));
  w_ += error.segment<3>(9);
  v_ *= std::min(1.0, kSpeedMax / std::max(v_.norm(), kSpeedMax));
  w_ *= std::min(1.0, thresholds_.spin_max / std::max(w_.norm(), thresholds_.spin_max));
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
