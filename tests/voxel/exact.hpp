// Triangle against box in exact arithmetic, by another way than separating axes: the triangle is cut with the box's six
// half-spaces, points are quotients of whole numbers, and what is left is empty or not.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <numeric>
#include <vector>

#include "engine/base/pose.hpp"

namespace verisim::exact {

/// The point p / w with w > 0, in lowest terms.
struct Point {
  Eigen::Matrix<std::int64_t, 3, 1> p;
  std::int64_t w;
};

inline Point reduced(Point point) {
  std::int64_t divisor = point.w;
  for (int i = 0; i < 3; ++i) divisor = std::gcd(divisor, point.p[i]);
  return {point.p / divisor, point.w / divisor};
}

/// Does the closed triangle share a point with the closed box of the given half side about the centre? Whole numbers
/// below 64 in size, so that all products stay below 2^62.
inline bool touches(const std::vector<Eigen::Vector3i>& triangle, const Eigen::Vector3i& center, int half_side) {
  std::vector<Point> polygon;
  for (const Eigen::Vector3i& corner : triangle) polygon.push_back({corner.cast<std::int64_t>(), 1});
  for (int axis = 0; axis < 3; ++axis) {
    for (const int sign : {-1, 1}) {
      // How far a point is outside, times w: sign (p - center w) - half_side w.
      const auto outside = [&](const Point& q) { return sign * (q.p[axis] - center[axis] * q.w) - half_side * q.w; };
      std::vector<Point> left;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Point& a = polygon[i];
        const Point& b = polygon[(i + 1) % polygon.size()];
        const std::int64_t da = outside(a), db = outside(b);
        if (da <= 0) left.push_back(a);
        if ((da < 0 && db > 0) || (da > 0 && db < 0)) {
          const std::int64_t wa = std::abs(db), wb = std::abs(da);
          left.push_back(reduced({wa * a.p + wb * b.p, wa * a.w + wb * b.w}));
        }
      }
      polygon = left;
    }
  }
  return !polygon.empty();
}

}  // namespace verisim::exact
