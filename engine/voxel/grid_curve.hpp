// The curve of an edge in grid coordinates (unit: one voxel) and its intersections with boxes and planes, in closed
// form.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "engine/base/pinned_math.hpp"
#include "engine/geometry/entity.hpp"

namespace verisim {

/// A box: center, and half its side along every axis.
struct GridBox {
  Vector3d center;
  double half;
  [[nodiscard]] bool contains(const Vector3d& p) const { return ((p - center).array().abs() <= half).all(); }
};

/// A point where a curve meets a plane. Uncertain if rounding decides whether it crosses: an end of the curve is
/// equally near, or the curve touches the plane without crossing it.
struct PlaneCrossing {
  Vector3d point;
  bool certain;
};

/// One bounded curve: straight pieces through points, or an arc p(t) = center + cos t a + sin t b.
class GridCurve {
 public:
  /// Transforms an edge's curve: p -> axes (p - origin) * scale. A freeform edge is its polyline.
  /// @pre scale is finite and above 0; axes and origin are finite
  GridCurve(const Edge& edge, const Matrix3d& axes, const Vector3d& origin, double scale);

  /// True if the curve passes through the closed box. 10 ns for a line, 100 ns for an arc.
  [[nodiscard]] bool passes(const GridBox& box) const;

  /// Adds the points with normal . p = offset to `found`. A decision by less than `epsilon` is uncertain.
  void cross(const Vector3d& normal, double offset, double epsilon, std::vector<PlaneCrossing>& found) const;

  /// Smallest and largest normal . p of the curve, for curves that are arcs: of the whole ellipse.
  [[nodiscard]] std::array<double, 2> extent(const Vector3d& normal) const;

  /// Calls visit(low, high) for the bounding boxes of pieces at most about one voxel long that make up the curve.
  template <class Visit>
  void for_each_piece(Visit visit) const;

  [[nodiscard]] const Vector3d& first() const { return points_.front(); }
  [[nodiscard]] const Vector3d& last() const { return points_.back(); }
  [[nodiscard]] bool is_closed() const { return is_full_; }

 private:
  [[nodiscard]] Vector3d at(double cosine, double sine) const { return center_ + cosine * a_ + sine * b_; }
  [[nodiscard]] bool in_range(double cosine, double sine) const;
  /// Calls visit(cosine, sine) for the solutions of a cos t + b sin t = c, in the range or not.
  template <class Visit>
  static void solve(double a, double b, double c, Visit visit);
  [[nodiscard]] bool arc_passes(const GridBox& box) const;
  void cross_arc(const Vector3d& normal, double offset, double epsilon, std::vector<PlaneCrossing>& found) const;

  bool is_arc_ = false;
  bool is_full_ = false;
  std::vector<Vector3d> points_;  // of the polyline; of an arc: its two ends
  Vector3d center_ = Vector3d::Zero(), a_ = Vector3d::Zero(), b_ = Vector3d::Zero();
  std::array<double, 2> range_ = {0, 0};                    // [rad]
  std::array<Eigen::Vector2d, 2> ends_ = {};                // (cos, sin) of the range's ends
  double middle_cosine_ = 0, middle_sine_ = 0, reach_ = 0;  // of the range; in_range: cos(t - middle) >= reach
};

template <class Visit>
void GridCurve::for_each_piece(Visit visit) const {
  if (is_arc_) {
    const double radius = std::max(a_.norm(), b_.norm());
    const double span = range_[1] - range_[0];
    const int pieces = std::max(static_cast<int>(std::ceil(span * radius)), 4);
    const double step = span / pieces;
    const Vector3d bulge = Vector3d::Constant(radius * step * step / 8);  // the arc's largest distance from its chord
    Vector3d p = points_.front();
    for (int i = 1; i <= pieces; ++i) {
      const double t = range_[0] + i * step;
      const Vector3d next = i == pieces ? points_.back() : at(pinned::cos(t), pinned::sin(t));
      visit(p.cwiseMin(next) - bulge, p.cwiseMax(next) + bulge);
      p = next;
    }
    return;
  }
  for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
    const Vector3d step = points_[i + 1] - points_[i];
    const int pieces = std::max(static_cast<int>(std::ceil(step.norm())), 1);
    for (int k = 0; k < pieces; ++k) {
      const Vector3d p = points_[i] + k / static_cast<double>(pieces) * step;
      const Vector3d next = points_[i] + (k + 1) / static_cast<double>(pieces) * step;
      visit(p.cwiseMin(next), p.cwiseMax(next));
    }
  }
}

}  // namespace verisim
