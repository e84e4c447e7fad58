// A body that a hand holds through a virtual coupling, and another that stands: the set-up of
// ../shared/reference/peers/README.md ("Driven insertion"), the coupling linearly implicit and saturated as there.
#pragma once

#include <cmath>

#include "engine/exact/convex_step.hpp"
#include "engine/exact/exact_link.hpp"
#include "tests/exact/peg.hpp"

namespace verisim::exact::test {

struct Hand {
  Vector3d position;  ///< where it wants the body's centre of mass [m]
  Quaterniond rotation;
  Vector3d velocity;
};

struct HeldBody {
  double mass;         ///< kg
  Vector3d inertia_B;  ///< kg m^2, about its axes
  double stiffness = 5000, angular_stiffness = 50;
  double damping = 2 * std::sqrt(stiffness * mass);
  double force_max = 100, torque_max = 5;
  double dt = 0.001;
  double margin = 0.0002, speed = 0.2;  ///< candidates: as near as margin + dt speed
  Pose X_WB;                            ///< of the centre of mass
  Vector3d v = Vector3d::Zero(), omega = Vector3d::Zero();

  ExactLink link;
  ConvexStep solver{4096};
  Vector6d last = Vector6d::Zero();

  // of the last step
  Vector3d contact_force = Vector3d::Zero();
  Wrench coupling;
  int iterations = 0;

  HeldBody(std::shared_ptr<const ExactBody> standing, std::shared_ptr<const ExactBody> held, double mass_,
           const Vector3d& inertia, const SearchThresholds& thresholds = {})
      : mass(mass_), inertia_B(inertia), link(std::move(standing), std::move(held), 4096, thresholds) {}

  /// The velocity without contact and the matrix of the convex problem.
  void pull(const Hand& hand, Matrix6d& M, Vector6d& u0) {
    const Matrix3d R = X_WB.rotation.toRotationMatrix();
    const Matrix3d I = R * inertia_B.asDiagonal() * R.transpose();
    const Matrix3d B = R * Matrix3d((2 * (angular_stiffness * inertia_B).cwiseSqrt()).asDiagonal()) * R.transpose();
    Vector3d force = stiffness * (hand.position - X_WB.position - dt * v) + damping * (hand.velocity - v);
    const Vector3d e = vector_from_rotation(hand.rotation * X_WB.rotation.conjugate());
    Vector3d torque = angular_stiffness * (e - dt * omega) - B * omega;
    M.setZero();
    M.topLeftCorner<3, 3>().diagonal().setConstant(mass);
    M.bottomRightCorner<3, 3>() = I;
    if (force.norm() > force_max) {
      force *= force_max / force.norm();
    } else {
      M.topLeftCorner<3, 3>().diagonal().array() += dt * damping + dt * dt * stiffness;
    }
    if (torque.norm() > torque_max) {
      torque *= torque_max / torque.norm();
    } else {
      M.bottomRightCorner<3, 3>() += dt * B;
      M.bottomRightCorner<3, 3>().diagonal().array() += dt * dt * angular_stiffness;
    }
    Vector6d rate;
    rate << force, torque - omega.cross(I * omega);
    coupling = {force, torque};
    u0 << v, omega;
    u0 += M.llt().solve(dt * rate);
  }

  /// Everything that `exact` costs in a frame: search and solution.
  void contact(const Matrix6d& M, const Vector6d& u0) {
    const BodyMotion standing;
    const BodyMotion held{X_WB, X_WB.position, {u0.head<3>(), u0.tail<3>()}, {v, omega}};
    link.find(standing, held, dt, margin + dt * speed);
    solver.clear();
    const int body = solver.add_body(X_WB.position, M, u0, last);
    solver.add_rows(link.rows().rows(), kFixed, body);
    iterations = solver.solve(dt);
    last = solver.velocity(body);
    contact_force = solver.wrench(body).force;
  }

  void move() {
    v = last.head<3>();
    omega = last.tail<3>();
    X_WB.position += dt * v;
    X_WB.rotation = (rotation_from_vector(dt * omega) * X_WB.rotation).normalized();
  }

  void step(const Hand& hand) {
    Matrix6d M;
    Vector6d u0;
    pull(hand, M, u0);
    contact(M, u0);
    move();
  }
};

/// A pin of 1 kg in a block.
struct HeldPin : HeldBody {
  double radius;

  HeldPin(double clearance, double chamfer, double spacing, const LoadOptions& load = {},
          const BodyOptions& options = {}, const SearchThresholds& thresholds = {})
      : HeldBody(body_of(block_solid(chamfer), spacing, load, options),
                 body_of(pin_solid(clearance), spacing, load, options), 1, inertia(kHoleRadius - clearance),
                 thresholds),
        radius(kHoleRadius - clearance) {}

  static Vector3d inertia(double radius) {
    const double across = (3 * radius * radius + kPinLength * kPinLength) / 12;
    return {across, across, 0.5 * radius * radius};
  }

  /// Deepest true overlap of the pin's side with the hole [m], from closed forms at many angles: the pin's ends against
  /// the wall, the wall's ends against the pin.
  [[nodiscard]] double overlap() const {
    constexpr int kAngles = 720;
    const Matrix3d R = X_WB.rotation.toRotationMatrix();
    double deepest = 0;
    for (int i = 0; i < kAngles; ++i) {
      const double angle = 2 * 3.14159265358979323846 * i / kAngles;
      const Vector3d ring(std::cos(angle), std::sin(angle), 0);
      for (const double end : {-1.0, 1.0}) {
        const Vector3d p = X_WB.position + R * (radius * ring + Vector3d(0, 0, end * kPinLength / 2));
        if (std::abs(p.z()) <= kBlockHeight / 2) deepest = std::max(deepest, p.head<2>().norm() - kHoleRadius);
        const Vector3d q = kHoleRadius * ring + Vector3d(0, 0, end * kBlockHeight / 2) - X_WB.position;
        const double along = R.col(2).dot(q);
        if (std::abs(along) <= kPinLength / 2) deepest = std::max(deepest, radius - (q - along * R.col(2)).norm());
      }
    }
    return deepest;
  }
};

}  // namespace verisim::exact::test
