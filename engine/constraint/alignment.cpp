#include "engine/constraint/alignment.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim {
namespace {

/// m, smallest clearance in eq. 8.2, which would else divide by zero. The finest fits are made to a micrometre.
constexpr double kClearanceMin = 1e-6;

/// Of a voxel: largest x at which a pin before its hole still has alpha > 0 without engagement (alignment.hpp).
constexpr double kGuidedX = 0.1;

struct AxisInA {
  Vector3d point, direction;
  double half_length;
};

AxisInA axis_of(const Constraint& c, Side side, const Pose& X_AB) {
  const ConstraintSide& s = c.side(side);
  if (side == Side::a) return {s.point, s.direction, s.half_length};
  return {X_AB * s.point, X_AB.rotation * s.direction, s.half_length};
}

/// Distance of a point from an infinite line.
double distance_to(const AxisInA& line, const Vector3d& p) {
  return (p - line.point).cross(line.direction).norm();
}

/// The place on `axis`, within its bounded length, that is closest to the infinite line `other`. If the lines are
/// nearly parallel all places are about equally close, so any of them will do.
double closest_place(const AxisInA& axis, const AxisInA& other, double sine_squared, double cosine) {
  const double along = (other.point - axis.point).dot(axis.direction - cosine * other.direction);
  if (sine_squared < 1e-24) return 0;
  return std::clamp(along / sine_squared, -axis.half_length, axis.half_length);
}

/// Radial clearance between a cone and a coaxial shape at the height `t` above the cone's point [m]: positive when
/// pulled out.
double clearance_in_cone(const ConstraintSide& cone, double t, double radius_other, bool cone_is_hole) {
  const double radius_here = cone.radius + t * cone.detail;
  return cone_is_hole ? radius_here - radius_other : radius_other - radius_here;
}

Misalignment of_axes(const Constraint& c, const Pose& X_AB) {
  const Side hole = opposite(c.pin);
  const AxisInA outer = axis_of(c, hole, X_AB);
  const AxisInA inner = axis_of(c, c.pin, X_AB);
  Misalignment m;
  m.cosine = outer.direction.dot(inner.direction);
  const double sine_squared = outer.direction.cross(inner.direction).squaredNorm();
  m.sine = std::sqrt(sine_squared);
  const double there = closest_place(outer, inner, sine_squared, m.cosine);
  m.distance = distance_to(inner, outer.point + there * outer.direction);

  const double center = (inner.point - outer.point).dot(outer.direction);
  const double reach = inner.half_length * std::abs(m.cosine);
  const double low = std::max(-outer.half_length, center - reach);
  const double high = std::min(outer.half_length, center + reach);
  m.engagement_length = std::max(0.0, high - low);
  m.engagement_length_max = 2 * std::min(outer.half_length, inner.half_length);
  const double middle = std::clamp((low + high) / 2, -outer.half_length, outer.half_length);
  m.offset = distance_to(inner, outer.point + middle * outer.direction);
  m.local_clearance = std::max(0.0, c.clearance);

  if (c.field == NormalField::about_ring) {
    m.offset = m.distance = (inner.point - outer.point).norm();
    m.engagement_length = m.engagement_length_max = 2 * c.side(hole).radius;
  }
  if (c.field == NormalField::about_cone) {
    const bool source_is_hole = c.normal_source == hole;
    const ConstraintSide& cone = c.side(c.normal_source);
    const AxisInA& cone_axis = source_is_hole ? outer : inner;
    const AxisInA& other_axis = source_is_hole ? inner : outer;
    const double t = (other_axis.point - cone_axis.point).dot(cone_axis.direction);
    m.local_clearance =
        std::max(0.0, clearance_in_cone(cone, t, c.side(opposite(c.normal_source)).radius, source_is_hole));
  }
  // Two cones mate only if they open the same way. For all other axes the sense of the direction has no meaning.
  const bool two_cones = c.a.detail > 0 && c.b.detail > 0 && c.field == NormalField::about_cone;
  if (!two_cones) m.cosine = std::abs(m.cosine);
  return m;
}

Misalignment of_planes(const Constraint& c, const Pose& X_AB) {
  const AxisInA a = axis_of(c, Side::a, X_AB);
  const AxisInA b = axis_of(c, Side::b, X_AB);
  Misalignment m;
  m.cosine = -a.direction.dot(b.direction);
  m.sine = a.direction.cross(b.direction).norm();
  const Vector3d between = b.point - a.point;
  m.distance = m.offset = std::min(std::abs(between.dot(a.direction)), std::abs(between.dot(b.direction)));
  return m;
}

Misalignment of_centers(const Constraint& c, const Pose& X_AB) {
  Misalignment m;
  m.distance = m.offset = (X_AB * c.b.point - c.a.point).norm();
  m.local_clearance = std::max(0.0, c.clearance);
  return m;
}

/// A ball (the pin) and the axis of the tube or cone that it lies in.
Misalignment of_ball_and_axis(const Constraint& c, const Pose& X_AB) {
  const Side hole = opposite(c.pin);
  const AxisInA axis = axis_of(c, hole, X_AB);
  const Vector3d ball = axis_of(c, c.pin, X_AB).point;
  const double t = (ball - axis.point).dot(axis.direction);
  Misalignment m;
  m.distance = distance_to(axis, ball);
  m.local_clearance = std::max(0.0, c.clearance);
  if (c.kind == ConstraintKind::annular) {
    m.offset = m.distance + std::max(0.0, std::abs(t) - axis.half_length);
  } else {
    // Clearance beside the ball, perpendicular to the cone's flank: cos h = 1 / sqrt(1 + tan^2 h).
    const ConstraintSide& cone = c.side(hole);
    const double cosine = 1 / std::sqrt(1 + cone.detail * cone.detail);
    m.local_clearance = std::max(0.0, (cone.radius + t * cone.detail) * cosine - c.side(c.pin).radius);
    m.offset = m.distance;
  }
  return m;
}

/// A roller's axis or a straight edge against a plane: theta is the angle out of the plane.
Misalignment of_axis_and_plane(const Constraint& c, const Pose& X_AB) {
  const AxisInA plane = axis_of(c, c.normal_source, X_AB);
  const AxisInA axis = axis_of(c, opposite(c.normal_source), X_AB);
  Misalignment m;
  m.sine = std::abs(plane.direction.dot(axis.direction));
  m.cosine = plane.direction.cross(axis.direction).norm();
  const double height = (axis.point - plane.point).dot(plane.direction);
  m.distance = m.offset = std::abs(height - c.side(opposite(c.normal_source)).radius);
  return m;
}

Misalignment of_ball_and_plane(const Constraint& c, const Pose& X_AB) {
  const AxisInA plane = axis_of(c, c.normal_source, X_AB);
  const Vector3d ball = axis_of(c, opposite(c.normal_source), X_AB).point;
  Misalignment m;
  m.distance = m.offset =
      std::abs((ball - plane.point).dot(plane.direction) - c.side(opposite(c.normal_source)).radius);
  return m;
}

/// x / s of the header.
double normalized_misalignment(const Constraint& c, const Misalignment& m, double voxel_size) {
  const double tangent = m.cosine > 0 ? m.sine / m.cosine : 1e9;
  switch (c.pairing) {
    case Pairing::plane_plane:
    case Pairing::axis_plane:
      return tangent * tangent;
    case Pairing::point_plane:
      return 0;
    case Pairing::axis_axis:
    case Pairing::point_point:
    case Pairing::point_axis:
      break;
  }
  return (m.offset + m.engagement_length / 2 * tangent - m.local_clearance) / voxel_size;
}

/// Factor for the engagement of a pin: 0 before its end has passed the rim, 1 once a voxel of its length is in (or all
/// of it, if it is shorter).
double engagement_fraction(const Constraint& c, const Misalignment& m, double voxel_size) {
  if (c.pairing != Pairing::axis_axis) return 1;
  return std::min(1.0, m.engagement_length / std::min(voxel_size, m.engagement_length_max));
}

/// d_c of eq. 8.2: the clearance where there is a fit, else the voxel size.
double distance_scale(const Constraint& c, const Misalignment& m, double voxel_size) {
  const bool is_fit = c.pin != Side::neither && c.field != NormalField::about_cone;
  return is_fit ? std::max(m.local_clearance, kClearanceMin) : voxel_size;
}

}  // namespace

Misalignment misalignment(const Constraint& constraint, const Pose& X_AB) {
  VERISIM_ASSERT(constraint.kind != ConstraintKind::none);
  switch (constraint.pairing) {
    case Pairing::axis_axis:
      return of_axes(constraint, X_AB);
    case Pairing::plane_plane:
      return of_planes(constraint, X_AB);
    case Pairing::point_point:
      return of_centers(constraint, X_AB);
    case Pairing::point_axis:
      return of_ball_and_axis(constraint, X_AB);
    case Pairing::axis_plane:
      return of_axis_and_plane(constraint, X_AB);
    case Pairing::point_plane:
      break;
  }
  return of_ball_and_plane(constraint, X_AB);
}

double alignment(AlignmentMeasure measure, const Constraint& constraint, const Misalignment& m,
                 const AlignmentScales& scales) {
  VERISIM_ASSERT(is_positive(scales.voxel_size));
  VERISIM_ASSERT(is_not_negative(scales.steepness));
  if (constraint.kind == ConstraintKind::none) return 0;
  if (!std::isfinite(m.offset + m.sine + m.cosine)) return 0;
  double alpha = 0;
  if (measure == AlignmentMeasure::by_type) {
    const double x_over_s = std::max(0.0, normalized_misalignment(constraint, m, scales.voxel_size));
    alpha = std::max((1 - x_over_s) * engagement_fraction(constraint, m, scales.voxel_size), 1 - x_over_s / kGuidedX);
  } else {
    const double theta = pinned::atan2(m.sine, m.cosine);
    double angle_term = theta;
    double distance_term = scales.steepness * m.distance / distance_scale(constraint, m, scales.voxel_size);
    if (measure == AlignmentMeasure::faas) {
      angle_term = theta * std::max(1.0, m.engagement_length / scales.voxel_size);
      distance_term = m.distance / scales.voxel_size;
    }
    alpha = 0.5 * pinned::exp(-angle_term) + 0.5 * pinned::exp(-distance_term);
  }
  return std::clamp(alpha, 0.0, 1.0);
}

double clear_of_hole(const Constraint& round, const Misalignment& m, const AlignmentScales& scales) {
  VERISIM_ASSERT(round.kind != ConstraintKind::none);
  VERISIM_ASSERT(round.pairing == Pairing::axis_axis);
  VERISIM_ASSERT(is_positive(scales.voxel_size));
  const double apart = m.offset - round.a.radius - round.b.radius;
  return std::isfinite(apart) ? std::clamp(apart / scales.voxel_size, 0.0, 1.0) : 0;
}

}  // namespace verisim
