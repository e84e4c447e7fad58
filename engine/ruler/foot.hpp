// The nearest point on one, two or three dividers at once. Private to this folder.
#pragma once

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "engine/ruler/csg.hpp"
#include "engine/ruler/values.hpp"

namespace verisim::ruler {

using DividerSet = std::array<std::uint32_t, 3>;

/// A point near x on all of the first n dividers of the set: Newton, each step the shortest one. Infinite where they
/// never cross.
[[nodiscard]] inline Vector3d foot(std::span<const Divider> dividers, const Vector3d& x, const DividerSet& set,
                                   std::size_t n) {
  Vector3d y = x;
  for (int step = 0; step < 8; ++step) {
    Matrix3d J = Matrix3d::Zero();
    Vector3d g = Vector3d::Zero();
    for (std::size_t k = 0; k < n; ++k) {
      const Local local = local_at(dividers[set[k]], y);
      J.row(static_cast<Eigen::Index>(k)) = local.gradient.transpose();
      g(static_cast<Eigen::Index>(k)) = local.value;
    }
    if (g.cwiseAbs().maxCoeff() < 1e-15) break;
    if (n == 1) {
      y -= g(0) * J.row(0).transpose();
      continue;
    }
    Matrix3d JJ = J * J.transpose();
    if (n == 2) JJ(2, 2) = 1;
    if (std::abs(JJ.determinant()) < 1e-12) return Vector3d::Constant(kInfinity);  // surfaces that never cross here
    y -= J.transpose() * (JJ.inverse() * g);
  }
  return y;
}

}  // namespace verisim::ruler
