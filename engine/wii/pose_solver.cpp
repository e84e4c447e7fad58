#include "engine/wii/pose_solver.hpp"

#include <cmath>

#include "engine/base/cholesky.hpp"
#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/wii/gravity.hpp"

namespace verisim::wii {
namespace {

constexpr int kIterations = 20;  // a bound of the work: usually 2 are enough, and who needs more is not found
// A step of a hundredth of the pose's own standard deviation changes nothing that is known. (A limit in metres would
// wait for directions that hardly anything determines.)
constexpr double kConverged = 1e-4;
constexpr double kDepthMin = 0.05;  // m, in front of the lens: a limit of the task, a quarter of kDistanceMin

constexpr double kNoWorse = 1 + 1e-9;  // beside a minimum the cost only rounds

Pose moved(const Pose& X_RH, const Vector6d& move) {
  return {X_RH.position + move.head<3>(), (rotation_from_vector(move.tail<3>()) * X_RH.rotation).normalized()};
}

}  // namespace

/// J^T W J, J^T W r and r^T W r over (position, left rotation vector) in R.
struct PoseSolver::Normal {
  Matrix6d A = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  double cost = 0;

  void add(const Vector6d& row, double residual, double weight) {
    A.noalias() += (weight * row) * row.transpose();
    b += weight * residual * row;
    cost += weight * residual * residual;
  }
};

PoseSolver::PoseSolver(const TrackerSettings& settings)

    : pinhole_(settings.fov),
      weight_(1 / (settings.pixel_sigma * settings.pixel_sigma)),
      step_max_(settings.thresholds.solver_step_max) {
  VERISIM_ASSERT(is_positive(settings.pixel_sigma));
  VERISIM_ASSERT(!settings.X_R1R2 || is_placement(*settings.X_R1R2));
  const Pose X_R2R1 = settings.X_R1R2.value_or(Pose()).inverse();
  R_iR_ = {Matrix3d::Identity(), X_R2R1.rotation.toRotationMatrix()};
  p_iR_ = {Vector3d::Zero(), X_R2R1.position};
}

bool PoseSolver::project(const Pose& X_RH, const Vector3d& p_H, int remote, Eigen::Vector2d& pixel) const {
  VERISIM_ASSERT(remote == 0 || remote == 1);
  const auto i = static_cast<std::size_t>(remote);
  const Vector3d p = R_iR_[i] * (X_RH * p_H) + p_iR_[i];
  if (!(p.z() > kDepthMin)) return false;
  pixel = pinhole_.project(p);
  return true;
}

bool PoseSolver::accumulate(std::span<const Sighting> sightings, const Upright& upright, const Pose& X_RH,
                            Normal& normal) const {
  const Matrix3d R_RH = X_RH.rotation.toRotationMatrix();
  for (const Sighting& s : sightings) {
    const auto i = static_cast<std::size_t>(s.remote);
    const Vector3d arm_R = R_RH * s.p_H;
    const Vector3d p = R_iR_[i] * (arm_R + X_RH.position) + p_iR_[i];
    if (!(p.z() > kDepthMin)) return false;
    const double a = p.x() / p.z();
    const double b = p.y() / p.z();
    const auto add = [&](const Vector3d& gradient_i, double residual) {
      const Vector3d gradient_R = R_iR_[i].transpose() * gradient_i;
      Vector6d row;
      row << gradient_R, arm_R.cross(gradient_R);
      normal.add(row, residual, weight_);
    };
    add(pinhole_.fx / p.z() * Vector3d(1, 0, -a), s.u - (kWidth / 2 + pinhole_.fx * a));
    add(pinhole_.fy / p.z() * Vector3d(0, 1, -b), s.v - (kHeight / 2 + pinhole_.fy * b));
  }
  // Entry (k, j) of R_LH moves with a rotation vector w as w . (column_j x e_k), both in L.
  const Matrix3d R_LH = upright.C_LR * R_RH;
  const auto add_entry = [&](int k, int j, double prior, double sigma) {
    const Vector3d gradient_L = R_LH.col(j).cross(Vector3d::Unit(k));
    Vector6d row;
    row << Vector3d::Zero(), upright.C_LR.transpose() * gradient_L;
    normal.add(row, prior - R_LH(k, j), 1 / (sigma * sigma));
  };
  add_entry(2, 0, upright.row_x, upright.sigma_x);
  add_entry(2, 1, upright.row_y, upright.sigma_y);
  add_entry(1, 0, 0, upright.sigma_roll);
  return true;
}

SolvedPose PoseSolver::solve(std::span<const Sighting> sightings, const Upright& upright, const Pose& start) const {
  VERISIM_ASSERT(sightings.size() <= kSightingsMax);
  for (const Sighting& s : sightings) VERISIM_ASSERT(s.remote == 0 || s.remote == 1);
  VERISIM_ASSERT(upright.sigma_x > 0);
  VERISIM_ASSERT(upright.sigma_y > 0);
  VERISIM_ASSERT(upright.sigma_roll > 0);
  SolvedPose solved;
  Pose at = start;
  Vector6d move = Vector6d::Zero();
  Matrix6d A = Matrix6d::Zero();  // at solved.X_RH
  double best_cost = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kIterations; ++step) {
    Normal normal;
    const bool in_front = accumulate(sightings, upright, at, normal);
    if (!in_front && step == 0) return solved;
    if (in_front && normal.cost <= best_cost * kNoWorse) {
      solved.X_RH = at;
      solved.cost = best_cost = normal.cost;
      A = normal.A;
      const Cholesky6 factor(A);
      if (!factor.is_positive_definite()) return solved;
      move = factor.solve(normal.b);
      const double length = move.cwiseAbs().maxCoeff();
      if (!std::isfinite(length)) return solved;
      if (length > step_max_) move *= step_max_ / length;
    } else {
      move /= 2;  // too far, where residuals bend
    }
    at = moved(solved.X_RH, move);
    if (!(move.dot(A * move) < kConverged)) continue;
    solved.X_RH = at;
    solved.covariance = Cholesky6(A).inverse();
    solved.found = true;
    return solved;
  }
  return solved;
}

void level(const SolvedPose& solved, const Matrix3d& C_LR, double tilt_variance, Pose& X_LH, Matrix6d& covariance) {
  X_LH.position = C_LR * solved.X_RH.position;
  X_LH.rotation = (Quaterniond(C_LR) * solved.X_RH.rotation).normalized();
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = C_LR;
  turn.bottomRightCorner<3, 3>() = C_LR;
  covariance = turn * solved.covariance * turn.transpose();
  add_tilt(covariance, X_LH.position, C_LR, tilt_variance);
}

}  // namespace verisim::wii
