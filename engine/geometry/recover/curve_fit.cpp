#include "engine/geometry/recover/curve_fit.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/base/pinned_math.hpp"
#include "engine/geometry/recover/surface_fit.hpp"

namespace verisim::recover {

namespace {

using pinned::kFullTurn;
constexpr double kParallel = 1 - 1e-8;   // cosine
constexpr std::size_t kSaysACircle = 4;  // points: three lie on a circle always
constexpr double kSlack = 3;             // tolerances: a curve of two surfaces is off where both are

/// x = center + first cos t + second sin t; a circle where both are equally long.
struct Oval {
  Vector3d center, normal, x_axis;
  double first, second;
};

double length_of(const std::vector<Vector3d>& points) {
  double length = 0;
  for (std::size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
  return length;
}

bool is_straight(const std::vector<Vector3d>& points, double tolerance) {
  const Vector3d way = points.back() - points.front();
  if (!(way.norm() > 0)) return false;
  const Vector3d direction = way.normalized();
  return std::ranges::all_of(points, [&](const Vector3d& p) {
    const Vector3d arm = p - points.front();
    return (arm - arm.dot(direction) * direction).norm() <= tolerance;
  });
}

// --- what two surfaces say ------------------------------------------------------------------------------------------

/// A circle about the axis of a round surface.
std::optional<Oval> about_axis(const SurfaceValue& round, const std::vector<Vector3d>& points) {
  double rho = 0, height = 0;
  for (const Vector3d& p : points) {
    const Profile f = profile_of(p, round.point, round.axis);
    rho += f.rho / static_cast<double>(points.size());
    height += f.height / static_cast<double>(points.size());
  }
  if (!(rho > 0)) return std::nullopt;
  return Oval{round.point + height * round.axis, round.axis, round.axis.unitOrthogonal(), rho, rho};
}

bool share_axis(const SurfaceValue& a, const SurfaceValue& b, double tolerance) {
  if (std::abs(a.axis.dot(b.axis)) < kParallel) return false;
  return b.kind == Kind::plane || profile_of(b.point, a.point, a.axis).rho <= kSlack * tolerance;
}

std::optional<Oval> cut(const SurfaceValue& plane, const SurfaceValue& cylinder) {
  const double cosine = plane.axis.dot(cylinder.axis);
  if (std::abs(cosine) < 1e-3) return std::nullopt;
  const double along = (plane.point - cylinder.point).dot(plane.axis) / cosine;
  const Vector3d slope = cylinder.axis - cosine * plane.axis;
  if (!(slope.norm() > 0)) return std::nullopt;
  return Oval{cylinder.point + along * cylinder.axis, plane.axis, slope.normalized(), cylinder.a / std::abs(cosine),
              cylinder.a};
}

std::optional<Oval> expected(std::vector<SurfaceValue> beside, const std::vector<Vector3d>& points, double tolerance) {
  if (beside.size() != 2) return std::nullopt;
  if (beside[0].kind == Kind::plane) std::swap(beside[0], beside[1]);
  const SurfaceValue &round = beside[0], &other = beside[1];
  if (round.kind == Kind::plane) return std::nullopt;
  if (round.kind == Kind::sphere && other.kind == Kind::plane) {
    SurfaceValue turned = round;
    turned.axis = other.axis;
    return about_axis(turned, points);
  }
  if (round.kind != Kind::sphere && share_axis(round, other, tolerance)) return about_axis(round, points);
  if (round.kind == Kind::cylinder && other.kind == Kind::plane) return cut(other, round);
  return std::nullopt;
}

std::optional<Oval> circle_through_points(const std::vector<Vector3d>& points) {
  const SurfaceValue plane = plane_through(points);
  const Vector3d x = plane.axis.unitOrthogonal(), y = plane.axis.cross(x);
  double size = 0;
  for (const Vector3d& p : points) size = std::max(size, (p - plane.point).norm());
  std::vector<Eigen::Vector2d> flat;
  for (const Vector3d& p : points) flat.emplace_back((p - plane.point).dot(x) / size, (p - plane.point).dot(y) / size);
  const auto circle = circle_through(flat);
  if (!circle) return std::nullopt;
  const double radius = size * circle->z();
  return Oval{plane.point + size * (circle->x() * x + circle->y() * y), plane.axis, x, radius, radius};
}

// --- from points to parameters --------------------------------------------------------------------------------------

double angle_on(const Oval& oval, const Vector3d& p) {
  const Vector3d arm = p - oval.center, y = oval.normal.cross(oval.x_axis);
  return pinned::atan2(arm.dot(y) / oval.second, arm.dot(oval.x_axis) / oval.first);
}

bool passes_through(const Oval& oval, const std::vector<Vector3d>& points, double tolerance) {
  return std::ranges::all_of(points, [&](const Vector3d& p) {
    const double t = angle_on(oval, p);
    const Vector3d y = oval.normal.cross(oval.x_axis);
    const Vector3d on = oval.center + oval.first * pinned::cos(t) * oval.x_axis + oval.second * pinned::sin(t) * y;
    return (p - on).norm() <= tolerance;
  });
}

/// How far around the polyline goes, seen against the normal.
double sweep_of(const Oval& oval, const std::vector<Vector3d>& points) {
  double sweep = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    double step = angle_on(oval, points[i]) - angle_on(oval, points[i - 1]);
    if (step > pinned::kPi) step -= kFullTurn;
    if (step < -pinned::kPi) step += kFullTurn;
    sweep += step;
  }
  return sweep;
}

void set_oval(Edge& edge, Oval oval) {
  const bool closed = edge.polyline.front() == edge.polyline.back();
  if (sweep_of(oval, edge.polyline) < 0) oval.normal = -oval.normal;
  const bool is_circle = oval.first == oval.second;
  if (is_circle) {  // it begins at its first point
    const Vector3d arm = edge.polyline.front() - oval.center;
    oval.x_axis = (arm - arm.dot(oval.normal) * oval.normal).normalized();
  }
  const double from = is_circle ? 0 : angle_on(oval, edge.polyline.front());
  edge.t_range = {from, from + (closed ? kFullTurn : sweep_of(oval, edge.polyline))};
  if (is_circle) {
    edge.curve = Circle{oval.center, oval.normal, oval.x_axis, oval.first};
    edge.length = oval.first * (edge.t_range[1] - edge.t_range[0]);
  } else {
    edge.curve = Ellipse{oval.center, oval.normal, oval.x_axis, oval.first, oval.second};
    edge.length = length_of(edge.polyline);
  }
}

}  // namespace

void set_curve(Edge& edge, const std::vector<const Surface*>& beside, double tolerance) {
  const std::vector<Vector3d>& points = edge.polyline;
  std::vector<SurfaceValue> values;
  for (const Surface* surface : beside) {
    if (const auto value = SurfaceValue::of(*surface)) values.push_back(*value);
  }
  const std::optional<Oval> oval = expected(values, points, tolerance);
  if (oval && passes_through(*oval, points, kSlack * tolerance)) return set_oval(edge, *oval);
  if (is_straight(points, tolerance)) {
    const Vector3d way = points.back() - points.front();
    edge.curve = Line{points.front(), way.normalized()};
    edge.length = way.norm();
    edge.t_range = {0, edge.length};
    return;
  }
  if (points.size() >= kSaysACircle) {
    const std::optional<Oval> circle = circle_through_points(points);
    if (circle && passes_through(*circle, points, kSlack * tolerance)) return set_oval(edge, *circle);
  }
  edge.curve = OtherCurve{};
  edge.length = length_of(points);
}

}  // namespace verisim::recover
