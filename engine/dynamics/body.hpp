// A rigid body: constant mass properties and the state that an integrator advances. The state is that of the centre of
// mass C, where the equations of Newton and Euler are simplest. The pose of the body coordinates B follows from it.
#pragma once

#include <string>

#include "engine/base/pose.hpp"

namespace verisim {

struct RigidBody {
  // constant
  double mass = 0;                        ///< kg, > 0
  Matrix3d inertia_B = Matrix3d::Zero();  ///< kg m^2, about C, axes of B
  Matrix3d inertia_inverse_B = Matrix3d::Zero();
  Vector3d principal_moments = Vector3d::Zero();     ///< kg m^2, ascending
  Matrix3d principal_axes_B = Matrix3d::Identity();  ///< their axes as columns, right-handed
  Vector3d p_BC = Vector3d::Zero();                  ///< m, centre of mass in body coordinates

  // state, world coordinates
  Vector3d p_WC = Vector3d::Zero();  ///< m
  Quaterniond R_WB = Quaterniond::Identity();
  Vector3d v_C = Vector3d::Zero();    ///< m/s
  Vector3d omega = Vector3d::Zero();  ///< rad/s

  [[nodiscard]] Pose pose() const { return {p_WC - R_WB * p_BC, R_WB}; }
  /// @pre X_WB is finite, its rotation unit
  void set_pose(const Pose& X_WB);
  [[nodiscard]] Matrix3d inertia_W() const {
    const Matrix3d R = R_WB.toRotationMatrix();
    return R * inertia_B * R.transpose();
  }
  [[nodiscard]] Matrix3d inertia_inverse_W() const {
    const Matrix3d R = R_WB.toRotationMatrix();
    return R * inertia_inverse_B * R.transpose();
  }
  /// M^-1 = diag(1/m, I_W^-1), world coordinates about C. @pre mass > 0
  [[nodiscard]] Matrix6d inverse_mass_matrix() const;
  [[nodiscard]] double kinetic_energy() const;  ///< J
  [[nodiscard]] bool is_finite() const;
};

/// A body of the given volume properties [m^3, m, m^5] and density [kg/m^3]. The smallest principal inertia is raised
/// to 1e-6 of the largest, so that a needle can be integrated. Error(input) naming `name` if density, mass, centroid or
/// inertia are not finite, or mass or a principal inertia are not positive (to 1e-6 of the largest).
[[nodiscard]] RigidBody make_body(const std::string& name, double volume, const Vector3d& centroid,
                                  const Matrix3d& inertia_per_density, double density);

/// The symmetric square root of a symmetric positive semidefinite matrix (for critical damping per principal axis).
/// @pre m is finite and symmetric
[[nodiscard]] Matrix3d square_root(const Matrix3d& m);

/// The smallest eigenvalue of a symmetric matrix. @pre m is finite and symmetric
[[nodiscard]] double smallest_eigenvalue(const Matrix3d& m);

}  // namespace verisim
