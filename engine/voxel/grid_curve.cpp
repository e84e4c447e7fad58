#include "engine/voxel/grid_curve.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/overloaded.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim {

namespace {

using pinned::kFullTurn;
constexpr double kSameAngle = 1e-9;  // rad: an arc that closes to this is a whole ellipse

/// Slabs: does the segment pq meet the closed box?
bool segment_passes(const Vector3d& p, const Vector3d& q, const GridBox& box) {
  double from = 0, to = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double start = p[axis] - box.center[axis], step = q[axis] - p[axis];
    if (step == 0) {
      if (std::abs(start) > box.half) return false;
      continue;
    }
    const double a = (-box.half - start) / step, b = (box.half - start) / step;
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
    if (from > to) return false;
  }
  return true;
}

}  // namespace

GridCurve::GridCurve(const Edge& edge, const Matrix3d& axes, const Vector3d& origin, double scale) {
  VERISIM_ASSERT(is_positive(scale));
  VERISIM_ASSERT(axes.allFinite());
  VERISIM_ASSERT(is_finite(origin));
  const auto placed = [&](const Vector3d& p) { return Vector3d(scale * (axes * (p - origin))); };
  const auto set_arc = [&](const Vector3d& center, const Vector3d& normal, const Vector3d& x_axis, double major,
                           double minor) {
    is_arc_ = true;
    center_ = placed(center);
    a_ = scale * major * (axes * x_axis);
    b_ = scale * minor * (axes * normal.cross(x_axis));
    range_ = edge.t_range;
    is_full_ = range_[1] - range_[0] >= kFullTurn - kSameAngle;
    for (std::size_t i = 0; i < 2; ++i) ends_[i] = {pinned::cos(range_[i]), pinned::sin(range_[i])};
    for (const Eigen::Vector2d& end : ends_) points_.push_back(at(end.x(), end.y()));
    const double middle = 0.5 * (range_[0] + range_[1]);
    middle_cosine_ = pinned::cos(middle);
    middle_sine_ = pinned::sin(middle);
    reach_ = pinned::cos(0.5 * (range_[1] - range_[0]));
  };
  const auto set_polyline = [&] {
    for (const Vector3d& p : edge.polyline) points_.push_back(placed(p));
    if (points_.empty()) points_.push_back(Vector3d::Constant(-1));  // nowhere: outside every surface voxel
  };
  std::visit(
      Overloaded{[&](const Line& c) {
                   for (const double t : edge.t_range) points_.push_back(placed(c.point + t * c.direction));
                 },
                 [&](const Circle& c) { set_arc(c.center, c.normal, c.x_axis, c.radius, c.radius); },
                 [&](const Ellipse& c) { set_arc(c.center, c.normal, c.x_axis, c.major_radius, c.minor_radius); },
                 [&](const OtherCurve&) { set_polyline(); }},
      edge.curve);
}

bool GridCurve::in_range(double cosine, double sine) const {
  return is_full_ || cosine * middle_cosine_ + sine * middle_sine_ >= reach_;
}

template <class Visit>
void GridCurve::solve(double a, double b, double c, Visit visit) {
  const double squared = a * a + b * b;
  const double under = squared - c * c;
  if (squared == 0 || under < 0) return;
  const double root = std::sqrt(under);
  visit((a * c - b * root) / squared, (b * c + a * root) / squared);
  visit((a * c + b * root) / squared, (b * c - a * root) / squared);
}

// An arc that is in the box has an end in it or enters it through a wall.
bool GridCurve::arc_passes(const GridBox& box) const {
  if (box.contains(points_[0]) || box.contains(points_[1])) return true;
  bool passes = false;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const double side : {-box.half, box.half}) {
      solve(a_[axis], b_[axis], box.center[axis] + side - center_[axis], [&](double cosine, double sine) {
        const Vector3d arm = at(cosine, sine) - box.center;
        passes |= std::abs(arm[u]) <= box.half && std::abs(arm[v]) <= box.half && in_range(cosine, sine);
      });
      if (passes) return true;
    }
  }
  return false;
}

bool GridCurve::passes(const GridBox& box) const {
  if (is_arc_) return arc_passes(box);
  if (points_.size() == 1) return box.contains(points_[0]);
  for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
    if (segment_passes(points_[i], points_[i + 1], box)) return true;
  }
  return false;
}

void GridCurve::cross_arc(const Vector3d& normal, double offset, double epsilon,
                          std::vector<PlaneCrossing>& found) const {
  const double a = normal.dot(a_), b = normal.dot(b_), c = offset - normal.dot(center_);
  const double amplitude = std::sqrt(a * a + b * b);
  const bool touches = std::abs(std::abs(c) - amplitude) <= epsilon;
  if (amplitude <= epsilon) {  // the arc lies along the plane
    if (touches) found.push_back({at(middle_cosine_, middle_sine_), false});
    return;
  }
  // At an end that is as near to the plane rounding decides on which side it ends.
  if (!is_full_) {
    for (const Vector3d& end : points_) {
      if (std::abs(normal.dot(end) - offset) <= epsilon) found.push_back({end, false});
    }
  }
  if (touches) {
    const double sign = c < 0 ? -1 : 1;
    const double cosine = sign * a / amplitude, sine = sign * b / amplitude;
    if (in_range(cosine, sine)) found.push_back({at(cosine, sine), false});
    return;
  }
  solve(a, b, c, [&](double cosine, double sine) {
    if (in_range(cosine, sine)) found.push_back({at(cosine, sine), true});
  });
}

void GridCurve::cross(const Vector3d& normal, double offset, double epsilon, std::vector<PlaneCrossing>& found) const {
  if (is_arc_) return cross_arc(normal, offset, epsilon, found);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const double here = normal.dot(points_[i]) - offset;
    if (std::abs(here) <= epsilon) found.push_back({points_[i], false});
    if (i == 0) continue;
    const double before = normal.dot(points_[i - 1]) - offset;
    if ((before < 0) == (here < 0)) continue;
    found.push_back({points_[i - 1] + before / (before - here) * (points_[i] - points_[i - 1]), true});
  }
}

std::array<double, 2> GridCurve::extent(const Vector3d& normal) const {
  if (is_arc_) {
    const double middle = normal.dot(center_);
    const double amplitude = Eigen::Vector2d(normal.dot(a_), normal.dot(b_)).norm();
    return {middle - amplitude, middle + amplitude};
  }
  std::array<double, 2> result = {normal.dot(points_[0]), normal.dot(points_[0])};
  for (const Vector3d& p : points_) {
    result[0] = std::min(result[0], normal.dot(p));
    result[1] = std::max(result[1], normal.dot(p));
  }
  return result;
}

}  // namespace verisim
