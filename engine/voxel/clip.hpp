// The part of a triangle inside a voxel.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "engine/base/pose.hpp"

namespace verisim {

/// A convex polygon: a triangle cut by up to six planes has at most nine corners.
struct Polygon {
  std::array<Vector3d, 9> corner;
  std::size_t size = 0;

  [[nodiscard]] bool empty() const { return size < 3; }
  [[nodiscard]] double low(int axis) const {
    double result = corner[0][axis];
    for (std::size_t i = 1; i < size; ++i) result = std::min(result, corner[i][axis]);
    return result;
  }
  [[nodiscard]] double high(int axis) const {
    double result = corner[0][axis];
    for (std::size_t i = 1; i < size; ++i) result = std::max(result, corner[i][axis]);
    return result;
  }
  /// Area, given the unit normal of the polygon's plane.
  [[nodiscard]] double area(const Vector3d& unit_normal) const {
    double twice = 0;
    for (std::size_t i = 1; i + 1 < size; ++i) {
      twice += (corner[i] - corner[0]).cross(corner[i + 1] - corner[0]).dot(unit_normal);
    }
    return 0.5 * std::abs(twice);
  }
};

/// The part of `polygon` with sign * p[axis] <= sign * limit.
[[nodiscard]] inline Polygon cut(const Polygon& polygon, int axis, double sign, double limit) {
  Polygon result;
  for (std::size_t i = 0; i < polygon.size; ++i) {
    const Vector3d& a = polygon.corner[i];
    const Vector3d& b = polygon.corner[i + 1 < polygon.size ? i + 1 : 0];
    const double da = sign * (a[axis] - limit), db = sign * (b[axis] - limit);
    if (da <= 0) result.corner[result.size++] = a;
    if ((da < 0 && db > 0) || (da > 0 && db < 0)) result.corner[result.size++] = a + da / (da - db) * (b - a);
  }
  return result;
}

/// The part of `polygon` with low <= p[axis] <= high.
[[nodiscard]] inline Polygon slab(const Polygon& polygon, int axis, double low, double high) {
  const Polygon below = cut(polygon, axis, 1, high);
  return below.empty() ? below : cut(below, axis, -1, low);
}

}  // namespace verisim
