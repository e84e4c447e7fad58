// Signed distance of a point to a precise surface, with its first and second derivatives: what a contact needs to know
// of a plane, cylinder, cone, sphere or torus.
//
// Body coordinates of the surface's body [m]. Distances are positive outside the material, negative inside it; normals
// point out of the material and are unit. The surface is taken without its bounds: which part of it belongs to a face
// is trim.hpp's subject.
#pragma once

#include <array>
#include <optional>

#include "engine/geometry/entity.hpp"

namespace verisim::exact {

/// Distance of one point, and how it changes around it.
struct SurfaceAt {
  double distance;  ///< m
  Vector3d normal;  ///< its gradient
  // Second derivatives: the distance is a function of radius and height about the axis only.
  Vector3d outward;          ///< unit, from the axis to the point
  double bend_around = 0;    ///< 1/m, along the circle about the axis
  double bend_meridian = 0;  ///< 1/m, in the plane of axis and point, across the normal
};

/// One of the five surfaces that are known precisely, in one shape for all of them: a meridian turned about an axis
/// (for a plane: about its normal).
class PreciseSurface {
 public:
  enum class Kind : std::uint8_t { plane, cylinder, cone, sphere, torus };

  /// Nothing for OtherSurface and for a surface without extent (zero radius, not finite).
  [[nodiscard]] static std::optional<PreciseSurface> from(const Surface& surface);

  /// About 40 flops, one square root (torus: two). On the axis of a round surface, where no direction is nearest, the
  /// answer is that of the surface's x axis.
  [[nodiscard]] SurfaceAt at(const Vector3d& p) const;

  /// Second derivative of the distance along the direction t: t^T H t [1/m for unit t].
  [[nodiscard]] double bend(const SurfaceAt& at, const Vector3d& t) const;

  /// A chart of the surface for points on it, without trigonometry: plane (x, y) [m]; cylinder and cone (turn, height
  /// [m]); sphere (turn, sine of the latitude); torus (turn, turn of the tube). A turn counts 0 to 4 once around.
  [[nodiscard]] std::array<double, 2> chart(const Vector3d& foot) const;

  [[nodiscard]] Kind kind() const { return kind_; }
  [[nodiscard]] const Vector3d& point() const { return point_; }
  [[nodiscard]] const Vector3d& axis() const { return axis_; }
  [[nodiscard]] const Vector3d& x_axis() const { return x_axis_; }
  [[nodiscard]] double radius() const { return radius_; }  ///< of the tube for a torus
  [[nodiscard]] double ring_radius() const { return ring_; }
  /// Material is inside (pin, ball), not around (hole). Planes: false.
  [[nodiscard]] bool is_convex() const { return kind_ != Kind::plane && side_ > 0; }

 private:
  Kind kind_ = Kind::plane;
  Vector3d point_ = Vector3d::Zero(), axis_ = Vector3d::UnitZ(), x_axis_ = Vector3d::UnitX(),
           y_axis_ = Vector3d::UnitY();
  double radius_ = 0;
  double ring_ = 0;                             ///< torus: distance of the tube's centre from the axis
  double cosine_ = 1, sine_ = 0, tangent_ = 0;  ///< cone: of the half angle
  double side_ = 1;                             ///< -1 for holes
};

/// 0 to 4 once around: grows with the angle of (x, y) from the x axis, needs no trigonometry. 0 at the origin.
[[nodiscard]] double turn_of(double x, double y);

// --- inline: the innermost loop of the search ----------------------------------------------------------------------

inline SurfaceAt PreciseSurface::at(const Vector3d& p) const {
  const Vector3d d = p - point_;
  const double height = d.dot(axis_);
  if (kind_ == Kind::plane) return {height, axis_, x_axis_, 0, 0};
  const Vector3d across = d - height * axis_;
  const double rho = across.norm();
  SurfaceAt at{0, Vector3d::Zero(), rho > 0 ? Vector3d(across / rho) : x_axis_, 0, 0};
  const double per_rho = rho > 0 ? side_ / rho : 0;
  switch (kind_) {
    case Kind::cylinder:
      at.distance = side_ * (rho - radius_);
      at.normal = side_ * at.outward;
      at.bend_around = per_rho;
      break;
    case Kind::cone:
      at.distance = side_ * cosine_ * (rho - radius_ - height * tangent_);
      at.normal = side_ * (cosine_ * at.outward - sine_ * axis_);
      at.bend_around = cosine_ * per_rho;
      break;
    default: {  // sphere: a torus whose ring has no radius
      const double q = rho - ring_;
      const double to_tube = std::sqrt(q * q + height * height);
      const double per_tube = to_tube > 0 ? side_ / to_tube : 0;
      at.distance = side_ * (to_tube - radius_);
      at.normal = to_tube > 0 ? Vector3d(per_tube * (q * at.outward + height * axis_)) : Vector3d(side_ * at.outward);
      at.bend_around = rho > 0 ? per_tube * q / rho : 0;
      at.bend_meridian = per_tube;
    }
  }
  return at;
}

inline double PreciseSurface::bend(const SurfaceAt& at, const Vector3d& t) const {
  const double along = t.dot(axis_);
  const double out = t.dot(at.outward);
  const double across = t.dot(at.normal);
  const double meridian = along * along + out * out;
  return at.bend_around * (t.squaredNorm() - meridian) + at.bend_meridian * (meridian - across * across);
}

}  // namespace verisim::exact
