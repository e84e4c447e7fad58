#include "engine/geometry/recover/curve_fit.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/geometry/recover/surface_fit.hpp"

namespace verisim::recover {

namespace {

using pinned::kFullTurn;
constexpr std::size_t kCirclePointsMin = 4;  // no heuristic: any three points lie on a circle

/// A circle or ellipse, p(t) = center + semi_x cos t x_axis + semi_y sin t (normal x x_axis). A circle if both
/// semi-axes are equal [m].
struct Conic {
  Vector3d center, normal, x_axis;
  double semi_x, semi_y;
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

// --- where two surfaces meet
// ------------------------------------------------------------------------------------------

/// The circle about the axis of a surface of revolution that is nearest to the points.
std::optional<Conic> circle_about_axis(const SurfaceValue& round, const std::vector<Vector3d>& points) {
  double rho = 0, height = 0;
  for (const Vector3d& p : points) {
    const Profile f = profile_of(p, round.point, round.axis);
    rho += f.rho / static_cast<double>(points.size());
    height += f.height / static_cast<double>(points.size());
  }
  if (!(rho > 0)) return std::nullopt;
  return Conic{round.point + height * round.axis, round.axis, round.axis.unitOrthogonal(), rho, rho};
}

bool are_coaxial(const SurfaceValue& a, const SurfaceValue& b, double tolerance, const RecoverThresholds& thresholds) {
  if (std::abs(a.axis.dot(b.axis)) < 1 - thresholds.not_parallel) return false;
  return b.kind == Kind::plane || profile_of(b.point, a.point, a.axis).rho <= thresholds.curve_slack * tolerance;
}

std::optional<Conic> plane_cylinder_section(const SurfaceValue& plane, const SurfaceValue& cylinder,
                                            double cosine_min) {
  const double cosine = plane.axis.dot(cylinder.axis);
  if (std::abs(cosine) < cosine_min) return std::nullopt;
  const double along = (plane.point - cylinder.point).dot(plane.axis) / cosine;
  const Vector3d slope = cylinder.axis - cosine * plane.axis;
  if (!(slope.norm() > 0)) return std::nullopt;
  return Conic{cylinder.point + along * cylinder.axis, plane.axis, slope.normalized(), cylinder.a / std::abs(cosine),
               cylinder.a};
}

std::optional<Conic> expected_conic(std::vector<SurfaceValue> beside, const std::vector<Vector3d>& points,
                                    double tolerance, const RecoverThresholds& thresholds) {
  if (beside.size() != 2) return std::nullopt;
  if (beside[0].kind == Kind::plane) std::swap(beside[0], beside[1]);
  const SurfaceValue &round = beside[0], &other = beside[1];
  if (round.kind == Kind::plane) return std::nullopt;
  if (round.kind == Kind::sphere && other.kind == Kind::plane) {
    SurfaceValue turned = round;
    turned.axis = other.axis;
    return circle_about_axis(turned, points);
  }
  if (round.kind != Kind::sphere && are_coaxial(round, other, tolerance, thresholds))
    return circle_about_axis(round, points);
  if (round.kind == Kind::cylinder && other.kind == Kind::plane)
    return plane_cylinder_section(other, round, thresholds.section_cosine_min);
  return std::nullopt;
}

std::optional<Conic> circle_through_points(const std::vector<Vector3d>& points) {
  const SurfaceValue plane = plane_through(points);
  const Vector3d x = plane.axis.unitOrthogonal(), y = plane.axis.cross(x);
  double size = 0;
  for (const Vector3d& p : points) size = std::max(size, (p - plane.point).norm());
  std::vector<Eigen::Vector2d> flat;
  for (const Vector3d& p : points) flat.emplace_back((p - plane.point).dot(x) / size, (p - plane.point).dot(y) / size);
  const auto circle = circle_through(flat);
  if (!circle) return std::nullopt;
  const double radius = size * circle->z();
  return Conic{plane.point + size * (circle->x() * x + circle->y() * y), plane.axis, x, radius, radius};
}

// --- from points to parameters --------------------------------------------------------------------------------------

double angle_on(const Conic& conic, const Vector3d& p) {
  const Vector3d arm = p - conic.center, y = conic.normal.cross(conic.x_axis);
  return pinned::atan2(arm.dot(y) / conic.semi_y, arm.dot(conic.x_axis) / conic.semi_x);
}

bool passes_through(const Conic& conic, const std::vector<Vector3d>& points, double tolerance) {
  return std::ranges::all_of(points, [&](const Vector3d& p) {
    const double t = angle_on(conic, p);
    const Vector3d y = conic.normal.cross(conic.x_axis);
    const Vector3d on = conic.center + conic.semi_x * pinned::cos(t) * conic.x_axis + conic.semi_y * pinned::sin(t) * y;
    return (p - on).norm() <= tolerance;
  });
}

/// Angle by which the polyline turns about the normal [rad].
double sweep_of(const Conic& conic, const std::vector<Vector3d>& points) {
  double sweep = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    double step = angle_on(conic, points[i]) - angle_on(conic, points[i - 1]);
    if (step > pinned::kPi) step -= kFullTurn;
    if (step < -pinned::kPi) step += kFullTurn;
    sweep += step;
  }
  return sweep;
}

void set_conic(Edge& edge, Conic conic) {
  const bool closed = edge.polyline.front() == edge.polyline.back();
  if (sweep_of(conic, edge.polyline) < 0) conic.normal = -conic.normal;
  const bool is_circle = conic.semi_x == conic.semi_y;
  if (is_circle) {  // t = 0 at its first point
    const Vector3d arm = edge.polyline.front() - conic.center;
    conic.x_axis = (arm - arm.dot(conic.normal) * conic.normal).normalized();
  }
  const double from = is_circle ? 0 : angle_on(conic, edge.polyline.front());
  edge.t_range = {from, from + (closed ? kFullTurn : sweep_of(conic, edge.polyline))};
  if (is_circle) {
    edge.curve = Circle{conic.center, conic.normal, conic.x_axis, conic.semi_x};
    edge.length = conic.semi_x * (edge.t_range[1] - edge.t_range[0]);
  } else {
    edge.curve = Ellipse{conic.center, conic.normal, conic.x_axis, conic.semi_x, conic.semi_y};
    edge.length = length_of(edge.polyline);
  }
}

}  // namespace

void set_curve(Edge& edge, const std::vector<const Surface*>& beside, double tolerance,
               const RecoverThresholds& thresholds) {
  const std::vector<Vector3d>& points = edge.polyline;
  VERISIM_ASSERT(points.size() >= 2);
  VERISIM_ASSERT(is_positive(tolerance));
  std::vector<SurfaceValue> values;
  for (const Surface* surface : beside) {
    VERISIM_ASSERT(surface != nullptr);
    if (const auto value = SurfaceValue::of(*surface)) values.push_back(*value);
  }
  const std::optional<Conic> conic = expected_conic(values, points, tolerance, thresholds);
  if (conic && passes_through(*conic, points, thresholds.curve_slack * tolerance)) return set_conic(edge, *conic);
  if (is_straight(points, tolerance)) {
    const Vector3d way = points.back() - points.front();
    edge.curve = Line{points.front(), way.normalized()};
    edge.length = way.norm();
    edge.t_range = {0, edge.length};
    return;
  }
  if (points.size() >= kCirclePointsMin) {
    const std::optional<Conic> circle = circle_through_points(points);
    if (circle && passes_through(*circle, points, thresholds.curve_slack * tolerance)) return set_conic(edge, *circle);
  }
  edge.curve = OtherCurve{};
  edge.length = length_of(points);
}

}  // namespace verisim::recover
