// Boxes that turn with bodies: are two of them certainly apart? World coordinates [m]. Source: Gottschalk, Lin and
// Manocha, "OBBTree", 1996: two boxes are apart if and only if they are along one of 15 directions.
#pragma once

#include <algorithm>
#include <cmath>

#include "engine/base/pose.hpp"

namespace verisim::exact {

struct OrientedBox {
  Vector3d center = Vector3d::Zero(), half = Vector3d::Zero();
  Matrix3d R = Matrix3d::Identity();  ///< its axes are the columns
};

/// True only if every point of one is farther than `margin` from every point of the other. It may be false beyond that:
/// where they are nearest at two corners they are farther apart than along any of the directions, and of edges that are
/// parallel to a millionth of a radian the direction across both is left to those of the faces.
[[nodiscard]] inline bool are_apart(const OrientedBox& a, const OrientedBox& b, double margin) {
  const Vector3d d = b.center - a.center;
  const double enough = margin + 1e-9 * (1 + d.norm());  // m: roundings
  constexpr double kParallel = 1e-6;  // rad: roundings of a shorter direction are more of it than `enough` covers
  const Matrix3d C = a.R.transpose() * b.R;
  const Matrix3d size = C.cwiseAbs();
  const Vector3d d_a = a.R.transpose() * d;
  const Vector3d d_b = b.R.transpose() * d;
  for (int i = 0; i < 3; ++i) {
    if (std::abs(d_a[i]) > a.half[i] + size.row(i).dot(b.half) + enough) return true;
    if (std::abs(d_b[i]) > b.half[i] + size.col(i).dot(a.half) + enough) return true;
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      // The direction a_i x b_j, in the axes of a; its length is the sine of the angle between them.
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      const double length = std::sqrt(C(i1, j) * C(i1, j) + C(i2, j) * C(i2, j));
      if (length < kParallel) continue;
      const double between = std::abs(d_a[i2] * C(i1, j) - d_a[i1] * C(i2, j));
      const double of_a = a.half[i1] * size(i2, j) + a.half[i2] * size(i1, j);
      const double of_b = b.half[j1] * size(i, j2) + b.half[j2] * size(i, j1);
      if (between > of_a + of_b + enough * length + 1e-9 * (of_a + of_b)) return true;
    }
  }
  return false;
}

}  // namespace verisim::exact
