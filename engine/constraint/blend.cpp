#include "engine/constraint/blend.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim {
namespace {

/// Damping relative to the trace of J^T J. It keeps unconstrained motions at zero and shortens the others by 1e-10.
constexpr double kDamping = 1e-10;
constexpr double kStepMin = 1e-9;  ///< m: a shorter step ends the iteration

/// The normal equations of all rows. Unknowns: B's displacement [m] and its rotation times `length` [m], about B's
/// centre.
class Rows {
 public:
  Rows(const Vector3d& center, double length) : center_(center), length_(length) {}

  /// The point p of B should move by `error` along `direction`.
  void place(const Vector3d& p, const Vector3d& direction, double error, double weight) {
    Vector6d row;
    row << direction, (p - center_).cross(direction) / length_;
    add(row, error, weight);
  }
  /// B should turn by `error` [rad] about `axis`.
  void turn(const Vector3d& axis, double error, double weight) {
    Vector6d row;
    row << Vector3d::Zero(), axis;
    add(row, length_ * error, weight);
  }

  [[nodiscard]] Vector6d step() const {
    Matrix6d damped = JtJ_;
    damped.diagonal().array() += kDamping * (1 + JtJ_.trace());
    const Eigen::LDLT<Matrix6d> factors(damped);
    return factors.solve(Jtr_);
  }
  [[nodiscard]] double squares() const { return squares_; }

 private:
  void add(const Vector6d& row, double error, double weight) {
    JtJ_.noalias() += weight * row * row.transpose();
    Jtr_ += weight * error * row;
    squares_ += weight * error * error;
  }
  Vector3d center_;
  double length_;
  Matrix6d JtJ_ = Matrix6d::Zero();
  Vector6d Jtr_ = Vector6d::Zero();
  double squares_ = 0;
};

/// Two unit vectors perpendicular to `axis` and to each other.
struct Across {
  Vector3d first, second;
  explicit Across(const Vector3d& axis) {
    int least = 0;
    axis.cwiseAbs().minCoeff(&least);
    first = axis.cross(Vector3d::Unit(least)).normalized();
    second = axis.cross(first);
  }
};

/// The two sides of a constraint in coordinates A. `wanted`: target of B's direction.
struct Sides {
  Vector3d a_point, a_direction, b_point, b_direction;
  Sides(const Constraint& c, const Pose& X_AB)
      : a_point(c.a.point),
        a_direction(c.a.direction),
        b_point(X_AB * c.b.point),
        b_direction(X_AB.rotation * c.b.direction) {}
};

/// Two rows that rotate B's direction onto `wanted`. The rotation vector is along b x wanted; its length is the angle.
void align_directions(Rows& rows, const Vector3d& b, const Vector3d& wanted, double weight) {
  const Vector3d cross = b.cross(wanted);
  const Across square(wanted);
  rows.turn(square.first, cross.dot(square.first), weight);
  rows.turn(square.second, cross.dot(square.second), weight);
}

void place_on_line(Rows& rows, const Vector3d& p, const Vector3d& point, const Vector3d& direction, double weight) {
  const Across square(direction);
  rows.place(p, square.first, (point - p).dot(square.first), weight);
  rows.place(p, square.second, (point - p).dot(square.second), weight);
}

void place_on_point(Rows& rows, const Vector3d& p, const Vector3d& wanted, double weight) {
  for (int axis = 0; axis < 3; ++axis) {
    rows.place(p, Vector3d::Unit(axis), wanted[axis] - p[axis], weight);
  }
}

/// Rows that put the axis or ball of one side at its radius from the plane of the other. The plane may be B's.
void place_at_height(Rows& rows, const Constraint& c, const Sides& s, double weight) {
  const bool plane_is_a = c.normal_source == Side::a;
  const Vector3d normal = plane_is_a ? s.a_direction : s.b_direction;
  const Vector3d above = plane_is_a ? Vector3d(s.b_point - s.a_point) : Vector3d(s.a_point - s.b_point);
  const double too_low = c.side(opposite(c.normal_source)).radius - above.dot(normal);
  rows.place(plane_is_a ? s.b_point : s.a_point, normal, plane_is_a ? too_low : -too_low, weight);
}

void add_axes(Rows& rows, const Constraint& c, const Sides& s, double weight) {
  const bool same_sense = s.a_direction.dot(s.b_direction) >= 0;
  align_directions(rows, s.b_direction, same_sense ? s.a_direction : Vector3d(-s.a_direction), weight);
  if (c.field == NormalField::about_ring) return place_on_point(rows, s.b_point, s.a_point, weight);
  // The pin's middle on the hole's axis. Either may be B, which moves.
  if (c.pin == Side::b) return place_on_line(rows, s.b_point, s.a_point, s.a_direction, weight);
  const Vector3d nearest = s.b_point + (s.a_point - s.b_point).dot(s.b_direction) * s.b_direction;
  place_on_line(rows, nearest, s.a_point, s.b_direction, weight);
}

void add_ball_on_axis(Rows& rows, const Constraint& c, const Sides& s, double weight) {
  if (c.pin == Side::b) return place_on_line(rows, s.b_point, s.a_point, s.a_direction, weight);
  const Vector3d nearest = s.b_point + (s.a_point - s.b_point).dot(s.b_direction) * s.b_direction;
  place_on_line(rows, nearest, s.a_point, s.b_direction, weight);
}

void add_axis_along_plane(Rows& rows, const Constraint& c, const Sides& s, double weight) {
  const bool plane_is_a = c.normal_source == Side::a;
  const Vector3d& normal = plane_is_a ? s.a_direction : s.b_direction;
  const Vector3d& axis = plane_is_a ? s.b_direction : s.a_direction;
  const Vector3d about = axis.cross(normal);
  const double length = about.norm();
  if (length > 0) {
    // Turning the axis about `axis x normal` lifts it towards the normal; turning the plane does the opposite.
    const double lift = -axis.dot(normal);
    rows.turn(about / length, plane_is_a ? lift : -lift, weight);
  }
  place_at_height(rows, c, s, weight);
}

void add(Rows& rows, const Constraint& c, const Pose& X_AB, double weight) {
  const Sides s(c, X_AB);
  switch (c.pairing) {
    case Pairing::axis_axis:
      return add_axes(rows, c, s, weight);
    case Pairing::plane_plane:
      align_directions(rows, s.b_direction, -s.a_direction, weight);
      rows.place(s.b_point, s.a_direction, (s.a_point - s.b_point).dot(s.a_direction), weight);
      return;
    case Pairing::point_point:
      return place_on_point(rows, s.b_point, s.a_point, weight);
    case Pairing::point_axis:
      return add_ball_on_axis(rows, c, s, weight);
    case Pairing::axis_plane:
      return add_axis_along_plane(rows, c, s, weight);
    case Pairing::point_plane:
      return place_at_height(rows, c, s, weight);
  }
}

/// `pose` with B rotated by `turn` about its `center` and displaced by `way`.
Pose moved(const Pose& pose, const Vector3d& center, const Vector3d& way, const Vector3d& turn) {
  const Quaterniond rotation = (rotation_from_vector(turn) * pose.rotation).normalized();
  return {pose * center + way - rotation * center, rotation};
}

}  // namespace

ConstraintForce constraint_force(std::span<const Engaged> engaged, const Pose& X_AB, const Vector3d& center,
                                 const BlendParameters& parameters) {
  VERISIM_ASSERT(is_not_negative(parameters.stiffness));
  VERISIM_ASSERT(is_not_negative(parameters.angular_stiffness));
  VERISIM_ASSERT(is_positive(parameters.length));
  ConstraintForce result;
  result.X_AB_target = X_AB;
  if (engaged.empty()) return result;
  VERISIM_ASSERT(is_placement(X_AB));
  VERISIM_ASSERT(is_finite(center));
  for (const Engaged& e : engaged) {
    VERISIM_ASSERT(e.constraint != nullptr);
    VERISIM_ASSERT(is_fraction(e.alpha));
    result.alpha = std::max(result.alpha, e.alpha);
  }

  for (; result.steps < parameters.steps_max; ++result.steps) {
    Rows rows(result.X_AB_target * center, parameters.length);
    for (const Engaged& e : engaged) add(rows, *e.constraint, result.X_AB_target, e.alpha);
    result.residual = std::sqrt(rows.squares());
    const Vector6d xi = rows.step();
    if (xi.squaredNorm() < kStepMin * kStepMin) break;
    result.X_AB_target = moved(result.X_AB_target, center, xi.head<3>(), xi.tail<3>() / parameters.length);
  }

  const Quaterniond turn = result.X_AB_target.rotation * X_AB.rotation.conjugate();
  result.on_b = {parameters.stiffness * (result.X_AB_target * center - X_AB * center),
                 parameters.angular_stiffness * vector_from_rotation(turn)};
  return result;
}

Wrench blended(const Wrench& collision, const Wrench& constraint, double alpha) {
  VERISIM_ASSERT(is_fraction(alpha));
  return {(1 - alpha) * collision.force + alpha * constraint.force,
          (1 - alpha) * collision.torque + alpha * constraint.torque};
}

}  // namespace verisim
