#include "engine/dynamics/body.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim {

void RigidBody::set_pose(const Pose& X_WB) {
  VERISIM_ASSERT(X_WB.position.allFinite());
  VERISIM_ASSERT(is_unit(X_WB.rotation));
  R_WB = X_WB.rotation;
  p_WC = X_WB * p_BC;
}

Matrix6d RigidBody::inverse_mass_matrix() const {
  VERISIM_ASSERT(mass > 0);
  Matrix6d m = Matrix6d::Zero();
  m.topLeftCorner<3, 3>().diagonal().setConstant(1 / mass);
  m.bottomRightCorner<3, 3>() = inertia_inverse_W();
  return m;
}

double RigidBody::kinetic_energy() const {
  return 0.5 * mass * v_C.squaredNorm() + 0.5 * omega.dot(inertia_W() * omega);
}

bool RigidBody::is_finite() const {
  return p_WC.allFinite() && R_WB.coeffs().allFinite() && v_C.allFinite() && omega.allFinite();
}

namespace {
/// Smallest principal inertia over the largest; rounding of a needle's inertia may also make it slightly negative.
constexpr double kInertiaRatioMin = 1e-6;
}  // namespace

RigidBody make_body(const std::string& name, double volume, const Vector3d& centroid,
                    const Matrix3d& inertia_per_density, double density) {
  if (!std::isfinite(density) || density <= 0)
    fail(ErrorKind::input, "'{}': density is {} kg/m^3 but must be finite and above 0", name, density);
  RigidBody body;
  body.mass = density * volume;
  body.p_BC = centroid;
  if (!std::isfinite(body.mass) || body.mass <= 0 || !centroid.allFinite() || !inertia_per_density.allFinite())
    fail(ErrorKind::input, "'{}': its mass is {} kg (volume {} m^3); a body needs a closed shape with positive volume",
         name, body.mass, volume);
  // Eigenvalues by QR iteration: square roots and products only, so the same bits everywhere.
  const Eigen::SelfAdjointEigenSolver<Matrix3d> principal(density * inertia_per_density);
  const double largest = principal.eigenvalues().maxCoeff();
  const double smallest = principal.eigenvalues().minCoeff();
  if (!(largest > 0) || smallest < -kInertiaRatioMin * largest)
    fail(ErrorKind::input, "'{}': its inertia is not positive; a body needs a closed, outward oriented shape", name);
  const Vector3d values = principal.eigenvalues().cwiseMax(kInertiaRatioMin * largest);
  const Matrix3d& axes = principal.eigenvectors();
  body.principal_moments = values;
  body.principal_axes_B << axes.col(0), axes.col(2).cross(axes.col(0)), axes.col(2);
  body.inertia_B = axes * values.asDiagonal() * axes.transpose();
  body.inertia_inverse_B = axes * values.cwiseInverse().asDiagonal() * axes.transpose();
  if (!body.inertia_B.allFinite() || !body.inertia_inverse_B.allFinite())
    fail(ErrorKind::input, "'{}': its inertia of {} kg m^2 is beyond double precision; check the model's scale", name,
         largest);
  return body;
}

Matrix3d square_root(const Matrix3d& m) {
  VERISIM_ASSERT(m.allFinite());
  VERISIM_ASSERT(is_symmetric(m));
  const Eigen::SelfAdjointEigenSolver<Matrix3d> principal(m);
  const Vector3d roots = principal.eigenvalues().cwiseMax(0).cwiseSqrt();
  return principal.eigenvectors() * roots.asDiagonal() * principal.eigenvectors().transpose();
}

double smallest_eigenvalue(const Matrix3d& m) {
  VERISIM_ASSERT(m.allFinite());
  VERISIM_ASSERT(is_symmetric(m));
  return Eigen::SelfAdjointEigenSolver<Matrix3d>(m, Eigen::EigenvaluesOnly).eigenvalues().minCoeff();
}

}  // namespace verisim
