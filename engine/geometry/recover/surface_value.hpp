// A surface as a fit varies it: a point, an axis, two sizes, for all kinds; and how the distance of a point varies with
// them. Distance and gradient themselves are those of engine/geometry/analytic_surface.hpp.
#pragma once

#include <optional>

#include "engine/geometry/analytic_surface.hpp"

namespace verisim::recover {

using Kind = SurfaceKind;

/// A point's place beside an axis; for a point on it any direction across it is outward.
[[nodiscard]] Profile profile_of(const Vector3d& p, const Vector3d& point, const Vector3d& axis);

struct SurfaceValue {
  Kind kind = Kind::plane;
  Vector3d point = Vector3d::Zero();
  Vector3d axis = Vector3d::UnitZ();
  double a = 0;  ///< cylinder, sphere: radius; cone: radius at `point`; torus: major radius, < 0 beyond the axis
  double b = 0;  ///< cone: tangent of the half angle, of either sign; torus: minor radius

  /// None for a surface without an equation.
  [[nodiscard]] static std::optional<SurfaceValue> of(const Surface& surface);
  /// A cone opens towards growing radius; `hole` is false.
  [[nodiscard]] Surface surface() const;
  /// A cone's half angle and a torus's ring may be negative.
  [[nodiscard]] Meridian meridian() const;

  /// Distance of p, positive outside of a round surface and where a plane's normal points [m].
  [[nodiscard]] double distance(const Vector3d& p) const;
  /// Its unit gradient.
  [[nodiscard]] Vector3d gradient(const Vector3d& p) const;

  using Row = Eigen::Matrix<double, 7, 1>;
  /// Distance of p and its derivatives by: shift of the point (3), tilt of the axis about x and y (2), a, b. A cone's
  /// by b leaves out what vanishes with the distance.
  [[nodiscard]] double row(const Vector3d& p, const Vector3d& x, const Vector3d& y, Row& derivatives) const;
  [[nodiscard]] SurfaceValue moved(const Row& step, const Vector3d& x, const Vector3d& y) const;
};

}  // namespace verisim::recover
