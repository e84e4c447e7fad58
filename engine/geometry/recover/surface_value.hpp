// What a surface says of a point, in one form for all kinds: a point, an axis, two sizes.
#pragma once

#include <optional>

#include "engine/geometry/entity.hpp"

namespace verisim::recover {

/// From simple to general: of two that explain the same, the first is meant.
enum class Kind { plane, cylinder, cone, sphere, torus };

/// A point's place beside an axis.
struct Profile {
  double rho, height;  ///< m, from the axis and along it
  Vector3d outward;    ///< unit, from the axis; any across it for a point on it
};
[[nodiscard]] Profile profile_of(const Vector3d& p, const Vector3d& point, const Vector3d& axis);

struct SurfaceValue {
  Kind kind = Kind::plane;
  Vector3d point = Vector3d::Zero();
  Vector3d axis = Vector3d::UnitZ();
  double a = 0;  ///< cylinder, sphere: radius; cone: radius at `point`; torus: major radius, < 0 beyond the axis
  double b = 0;  ///< cone: tangent of the half angle, of either sign; torus: minor radius

  /// None for a surface of another kind.
  [[nodiscard]] static std::optional<SurfaceValue> of(const Surface& surface);
  /// A cone opens towards growing radius; `hole` is false.
  [[nodiscard]] Surface surface() const;

  /// Distance of p, positive outside of a round surface and where a plane's normal points [m].
  [[nodiscard]] double distance(const Vector3d& p) const;
  /// Its unit gradient.
  [[nodiscard]] Vector3d gradient(const Vector3d& p) const;
  /// The smaller radius of curvature near p [m].
  [[nodiscard]] double radius_near(const Vector3d& p) const;

  using Row = Eigen::Matrix<double, 7, 1>;
  /// Distance of p and its derivatives by: shift of the point (3), tilt of the axis about x and y (2), a, b.
  [[nodiscard]] double row(const Vector3d& p, const Vector3d& x, const Vector3d& y, Row& derivatives) const;
  [[nodiscard]] SurfaceValue moved(const Row& step, const Vector3d& x, const Vector3d& y) const;
};

}  // namespace verisim::recover
