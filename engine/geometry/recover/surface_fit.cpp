#include "engine/geometry/recover/surface_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim::recover {

namespace {

using Row = SurfaceValue::Row;
using Normal =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 7, 7>;  // 7 x 7; of fixed size it costs 5 s of a compile

// Bounds of the work and of rounding, no heuristics: those are in RecoverThresholds.
constexpr int kIterations = 40;
constexpr int kFirst = 2;                   // iterations before a fit is asked to be near, or to get there fast
constexpr double kMostDamping = 1e6;        // no step is shorter than a millionth of the gradient's
constexpr double kSmallestDamping = 1e-13;  // holds the directions in which a kind does not change
constexpr double kSingular = 1e-12, kNearlySingular = 1e-9;  // reciprocal condition, of points and of squared normals

// --- least squares --------------------------------------------------------------------------------------------------

double cost_of(const SurfaceValue& s, std::span<const Vector3d> points) {
  double cost = 0;
  for (const Vector3d& p : points) {
    const double distance = s.distance(p);
    cost += distance * distance;
  }
  return cost;
}

SurfaceValue refined(SurfaceValue s, std::span<const Vector3d> points, double tolerance,
                     const RecoverThresholds& thresholds) {
  const double near = thresholds.near_fit, fine = thresholds.fine_fit;
  const double wanted = tolerance * tolerance * static_cast<double>(points.size());
  double cost = cost_of(s, points), damping = 1e-4;
  for (int i = 0; i < kIterations && cost > 0; ++i) {
    const Vector3d x = s.axis.unitOrthogonal(), y = s.axis.cross(x);
    Normal normal = Normal::Zero(7, 7);
    Row right = Row::Zero(), d;
    for (const Vector3d& p : points) {
      const double distance = s.row(p, x, y, d);
      normal += d * d.transpose();
      right -= distance * d;
    }
    const double scale = normal.trace() / 7;
    const double cost_before = cost;
    while (damping < kMostDamping) {
      Normal damped = normal;
      damped.diagonal().array() += std::max(damping * damping, kSmallestDamping) * scale;
      const SurfaceValue next = s.moved(damped.ldlt().solve(right), x, y);
      const double next_cost = cost_of(next, points);
      if (next_cost < cost) {
        s = next;
        cost = next_cost;
        damping *= 0.1;
        break;
      }
      damping *= 10;
    }
    const bool is_slow_at_most = i < kFirst || cost < near * near * wanted;
    if (cost < fine * fine * wanted || !(cost < (is_slow_at_most ? thresholds.settled : thresholds.fast) * cost_before))
      break;
  }
  return s;
}

// --- first guesses, in coordinates in which the sample lies around zero with size one --------------------------------

Vector3d smallest_axis(const Matrix3d& m) {
  return Eigen::SelfAdjointEigenSolver<Matrix3d>(m).eigenvectors().col(0);
}

std::optional<SurfaceValue> guess_cylinder(const Sample& s) {
  Matrix3d m = Matrix3d::Zero();
  for (const Vector3d& n : s.normals) m += n * n.transpose();
  const Vector3d axis = smallest_axis(m), x = axis.unitOrthogonal(), y = axis.cross(x);
  std::vector<Eigen::Vector2d> across;
  for (const Vector3d& p : s.points) across.emplace_back(p.dot(x), p.dot(y));
  const auto circle = circle_through(across);
  if (!circle) return std::nullopt;
  return SurfaceValue{Kind::cylinder, circle->x() * x + circle->y() * y, axis, circle->z()};
}

/// Planes along a cone meet in its apex, and their normals are on a circle about its axis.
std::optional<SurfaceValue> guess_cone(const Sample& s) {
  Matrix3d spread = Matrix3d::Zero(), planes = Matrix3d::Zero();
  Vector3d mean = Vector3d::Zero(), right = Vector3d::Zero();
  for (const Vector3d& n : s.normals) mean += n / static_cast<double>(s.normals.size());
  for (std::size_t i = 0; i < s.normals.size(); ++i) {
    const Vector3d& n = s.normals[i];
    spread += (n - mean) * (n - mean).transpose();
    planes += n * n.transpose();
    right += n.dot(s.centers[i]) * n;
  }
  const Eigen::FullPivLU<Matrix3d> lu(planes);
  if (lu.rcond() < kNearlySingular) return std::nullopt;
  const Vector3d apex = lu.solve(right);
  const Vector3d axis = smallest_axis(spread);
  double rho = 0, height = 0;
  for (const Vector3d& p : s.points) {
    const Profile f = profile_of(p, apex, axis);
    rho += f.rho;
    height += f.height;
  }
  if (!(std::abs(height) > kSingular)) return std::nullopt;
  const double tangent = rho / height, middle = height / static_cast<double>(s.points.size());
  return SurfaceValue{Kind::cone, apex + middle * axis, axis, middle * tangent, tangent};
}

std::optional<SurfaceValue> guess_sphere(const Sample& s) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (const Vector3d& p : s.points) {
    const Eigen::Vector4d row(2 * p.x(), 2 * p.y(), 2 * p.z(), 1);
    m += row * row.transpose();
    right += p.squaredNorm() * row;
  }
  const Eigen::FullPivLU<Eigen::Matrix4d> lu(m);
  if (lu.rcond() < kSingular) return std::nullopt;
  const Eigen::Vector4d c = lu.solve(right);
  const double squared = c[3] + c.head<3>().squaredNorm();
  if (!(squared > 0)) return std::nullopt;
  return SurfaceValue{Kind::sphere, c.head<3>(), Vector3d::UnitZ(), std::sqrt(squared)};
}

/// The normals of a surface of revolution meet its axis: the line whose complex they fit best (Pottmann and Wallner,
/// Computational Line Geometry, 2001). About it the profile is a circle.
std::optional<SurfaceValue> guess_torus(const Sample& s) {
  Matrix3d nn = Matrix3d::Zero(), mn = Matrix3d::Zero(), mm = Matrix3d::Zero();
  for (std::size_t i = 0; i < s.normals.size(); ++i) {
    const Vector3d& n = s.normals[i];
    const Vector3d moment = s.centers[i].cross(n);
    nn += n * n.transpose();
    mn += moment * n.transpose();
    mm += moment * moment.transpose();
  }
  const Eigen::FullPivLU<Matrix3d> lu(nn);
  if (lu.rcond() < kNearlySingular) return std::nullopt;
  const Matrix3d solved = lu.solve(mn.transpose());
  const Vector3d axis = smallest_axis(mm - mn * solved);
  const Vector3d point = axis.cross(-(solved * axis));
  std::vector<Eigen::Vector2d> profiles;
  for (const Vector3d& p : s.points) {
    const Profile f = profile_of(p, point, axis);
    profiles.emplace_back(f.rho, f.height);
  }
  const auto circle = circle_through(profiles);
  if (!circle) return std::nullopt;
  return SurfaceValue{Kind::torus, point + circle->y() * axis, axis, circle->x(), circle->z()};
}

std::optional<SurfaceValue> guess(Kind kind, const Sample& sample) {
  switch (kind) {
    case Kind::plane:
      return plane_through(sample.points);
    case Kind::cylinder:
      return guess_cylinder(sample);
    case Kind::cone:
      return guess_cone(sample);
    case Kind::sphere:
      return guess_sphere(sample);
    case Kind::torus:
      return guess_torus(sample);
  }
  return std::nullopt;
}

// --- scaling --------------------------------------------------------------------------------------------------------

/// Coordinates about the middle of the points, in units of their size: what is fitted has numbers near 1.
struct Scaling {
  Vector3d center = Vector3d::Zero();
  double size = 0;

  explicit Scaling(std::span<const Vector3d> points) {
    for (const Vector3d& p : points) center += p / static_cast<double>(points.size());
    for (const Vector3d& p : points) size = std::max(size, (p - center).norm());
  }
  [[nodiscard]] std::vector<Vector3d> into(std::span<const Vector3d> points) const {
    std::vector<Vector3d> result;
    result.reserve(points.size());
    for (const Vector3d& p : points) result.emplace_back((p - center) / size);
    return result;
  }
  /// `factor` is the size or its reciprocal.
  static SurfaceValue scaled(SurfaceValue s, double factor) {
    s.a *= factor;
    if (s.kind == Kind::torus) s.b *= factor;
    return s;
  }
  [[nodiscard]] SurfaceValue into(SurfaceValue s) const {
    s.point = (s.point - center) / size;
    return scaled(s, 1 / size);
  }
  [[nodiscard]] SurfaceValue out(SurfaceValue s) const {
    s.point = center + size * s.point;
    return scaled(s, size);
  }
};

/// Its point where the axis passes the middle of the sample: axes are not to wander along themselves.
void settle(SurfaceValue& s) {
  if (s.kind != Kind::cylinder && s.kind != Kind::cone) return;
  const double along = s.point.dot(s.axis);
  s.point -= along * s.axis;
  if (s.kind == Kind::cone) s.a -= along * s.b;
}

bool is_sound(const SurfaceValue& s, const RecoverThresholds& thresholds) {
  const double largest = thresholds.largest_radius;
  if (!s.point.allFinite() || !s.axis.allFinite() || !std::isfinite(s.a + s.b)) return false;
  if (s.kind == Kind::plane) return true;
  if (s.kind == Kind::cone) return std::abs(s.b) > thresholds.narrowest_cone && std::abs(s.b) < thresholds.widest_cone;
  if (s.kind == Kind::torus) return std::abs(s.a) < largest && s.b > std::max(-s.a, 0.0) && s.b < largest;
  return s.a > 0 && s.a < largest;
}

std::optional<SurfaceValue> result_of(SurfaceValue s, std::span<const Vector3d> points, const Scaling& scaling,
                                      double tolerance, const RecoverThresholds& thresholds) {
  s = refined(s, points, tolerance / scaling.size, thresholds);
  settle(s);
  if (!is_sound(s, thresholds)) return std::nullopt;
  return scaling.out(s);
}

/// Enough of many points.
std::vector<Vector3d> thinned(std::span<const Vector3d> points, std::size_t enough) {
  const std::size_t step = points.size() / enough + 1;
  std::vector<Vector3d> some;
  for (std::size_t i = 0; i < points.size(); i += step) some.push_back(points[i]);
  return some;
}

}  // namespace

std::optional<Vector3d> circle_through(std::span<const Eigen::Vector2d> points) {
  Matrix3d m = Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (const Eigen::Vector2d& p : points) {
    const Vector3d row(2 * p.x(), 2 * p.y(), 1);
    m += row * row.transpose();
    right += p.squaredNorm() * row;
  }
  const Eigen::FullPivLU<Matrix3d> lu(m);
  if (lu.rcond() < kSingular) return std::nullopt;
  const Vector3d s = lu.solve(right);
  const double squared = s.z() + s.head<2>().squaredNorm();
  if (!(squared > 0)) return std::nullopt;
  return Vector3d(s.x(), s.y(), std::sqrt(squared));
}

SurfaceValue plane_through(std::span<const Vector3d> points) {
  VERISIM_ASSERT(!points.empty());
  const Scaling scaling(points);
  Matrix3d m = Matrix3d::Zero();
  for (const Vector3d& p : points) m += (p - scaling.center) * (p - scaling.center).transpose();
  return SurfaceValue{Kind::plane, scaling.center, smallest_axis(m)};
}

std::optional<SurfaceValue> fit(Kind kind, const Sample& sample, double tolerance,
                                const RecoverThresholds& thresholds) {
  VERISIM_ASSERT(sample.centers.size() == sample.normals.size());
  VERISIM_ASSERT(is_positive(tolerance));
  const Scaling scaling(sample.points);
  if (!(scaling.size > 0)) return std::nullopt;
  const Sample scaled{scaling.into(thinned(sample.points, thresholds.points_of_a_fit)), scaling.into(sample.centers),
                      sample.normals};
  const std::optional<SurfaceValue> start = guess(kind, scaled);
  if (!start) return std::nullopt;
  return result_of(*start, scaled.points, scaling, tolerance, thresholds);
}

std::optional<SurfaceValue> refit(const SurfaceValue& guess, std::span<const Vector3d> points, double tolerance,
                                  const RecoverThresholds& thresholds) {
  VERISIM_ASSERT(is_positive(tolerance));
  const Scaling scaling(points);
  if (!(scaling.size > 0)) return std::nullopt;
  SurfaceValue start = scaling.into(guess);
  settle(start);
  return result_of(start, scaling.into(points), scaling, tolerance, thresholds);
}

}  // namespace verisim::recover
