// Bodies whose mass properties are known by hand.
#pragma once

#include "engine/dynamics/body.hpp"

namespace verisim::test {

/// A box of the given mass [kg] and edge lengths [m], at rest in the world's origin.
[[nodiscard]] inline RigidBody brick(double mass, const Vector3d& edges) {
  const double volume = edges.prod();
  const Vector3d squares = edges.cwiseAbs2();
  const Vector3d per_volume = (Vector3d::Constant(squares.sum()) - squares) / 12;
  const Matrix3d inertia_per_density = volume * Matrix3d(per_volume.asDiagonal());
  return make_body("brick", volume, Vector3d::Zero(), inertia_per_density, mass / volume);
}

[[nodiscard]] inline Vector3d angular_momentum(const RigidBody& body) {
  return body.inertia_W() * body.omega;
}

}  // namespace verisim::test
