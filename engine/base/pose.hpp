// Positions and orientations. Right-handed, SI. X_WB maps body coordinates B to world coordinates W:
// p_W = X_WB * p_B. Quaternions are unit; stored x, y, z, w wherever they leave the program.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace verisim {

using Vector3d = Eigen::Vector3d;
using Vector3f = Eigen::Vector3f;
using Matrix3d = Eigen::Matrix3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;  ///< linear part first, then angular
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Quaterniond = Eigen::Quaterniond;

/// A rigid placement X_WB.
struct Pose {
  Vector3d position = Vector3d::Zero();            ///< origin of B in W [m]
  Quaterniond rotation = Quaterniond::Identity();  ///< unit

  [[nodiscard]] Vector3d operator*(const Vector3d& p) const { return rotation * p + position; }
  [[nodiscard]] Pose operator*(const Pose& other) const {
    return {rotation * other.position + position, (rotation * other.rotation).normalized()};
  }
  [[nodiscard]] Pose inverse() const {
    const Quaterniond conjugate = rotation.conjugate();
    return {-(conjugate * position), conjugate};
  }
};

/// A force and a torque about a stated point [N, N m].
struct Wrench {
  Vector3d force = Vector3d::Zero();
  Vector3d torque = Vector3d::Zero();
  Wrench& operator+=(const Wrench& other) {
    force += other.force;
    torque += other.torque;
    return *this;
  }
  [[nodiscard]] Wrench operator-() const { return {-force, -torque}; }
};

/// What a wrench that acts on one body about p_on is to the body that causes it, about p_other: equal and opposite.
[[nodiscard]] inline Wrench reaction(const Wrench& wrench, const Vector3d& p_on, const Vector3d& p_other) {
  const Vector3d arm = p_on - p_other;
  return {-wrench.force, -(wrench.torque + arm.cross(wrench.force))};
}

/// A velocity [m/s] of a stated point and an angular velocity [rad/s], world coordinates.
struct Twist {
  Vector3d linear = Vector3d::Zero();
  Vector3d angular = Vector3d::Zero();
};

/// The smallest rotation that turns the direction of a into that of b; of opposite ones a half turn about some axis
/// across them. @pre neither is zero. Eigen's FromTwoVectors brings a singular value decomposition: 5 s of each
/// compile.
[[nodiscard]] Quaterniond turn_between(const Vector3d& a, const Vector3d& b);

/// The rotation by the vector w (axis times angle, rad). Pinned functions; exact identity at w = 0.
[[nodiscard]] Quaterniond rotation_from_vector(const Vector3d& w);

/// The shortest rotation vector of q: rotation_from_vector(vector_from_rotation(q)) = ±q. Its length is in [0, pi].
[[nodiscard]] Vector3d vector_from_rotation(const Quaterniond& q);

/// Great-circle interpolation from a (s = 0) to b (s = 1), the short way round. Pinned functions.
[[nodiscard]] Quaterniond slerp(const Quaterniond& a, const Quaterniond& b, double s);

/// [w]x, the matrix with [w]x v = w x v.
[[nodiscard]] Matrix3d skew(const Vector3d& w);

}  // namespace verisim
