// Signed distance of a point to a precise surface and its gradient: what a contact needs to know
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

/// Distance of one point, and its gradient.
struct SurfaceAt {
  double distance;  ///< m
  Vector3d normal;
};

/// One of the five surfaces that are known precisely, in one shape for all of them: a meridian turned about an axis
/// (for a plane: about its normal).
class PreciseSurface {
 public:
  enum class Kind : std::uint8_t { plane, cylinder, cone, sphere, torus };

  /// Nothing for OtherSurface and for a surface without extent (zero radius, not finite).
  [[nodiscard]] static std::optional<PreciseSurface> from(const Surface& surface);

  /// About 40 flops, one square root (torus: two). On the axis of a round surface (within a picometre), where no
  /// direction is nearest, the answer is that of the surface's x axis.
  [[nodiscard]] SurfaceAt at(const Vector3d& p) const;

  /// A chart of the surface for points on it, without trigonometry: plane (x, y) [m]; cylinder and cone (turn, height
  /// [m]); sphere (turn, sine of the latitude); torus (turn, turn of the tube). A turn counts 0 to 4 once around.
  [[nodiscard]] std::array<double, 2> chart(const Vector3d& foot) const;

  /// A vector in the surface's own axes: x axis, axis cross x axis, axis.
  [[nodiscard]] Vector3d to_own_axes(const Vector3d& v) const { return {v.dot(x_axis_), v.dot(y_axis_), v.dot(axis_)}; }

  [[nodiscard]] Kind kind() const { return kind_; }
  [[nodiscard]] const Vector3d& point() const { return point_; }
  [[nodiscard]] const Vector3d& axis() const { return axis_; }
  [[nodiscard]] const Vector3d& x_axis() const { return x_axis_; }
  [[nodiscard]] double radius() const { return radius_; }  ///< of the tube for a torus
  [[nodiscard]] double ring_radius() const { return ring_; }
  [[nodiscard]] double cosine() const { return cosine_; }  ///< cone: of the half angle
  [[nodiscard]] double sine() const { return sine_; }
  [[nodiscard]] double tangent() const { return tangent_; }
  [[nodiscard]] double side() const { return side_; }  ///< -1 for holes, else 1
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
  if (kind_ == Kind::plane) return {height, axis_};
  const Vector3d across = d - height * axis_;
  const double rho = across.norm();
  constexpr double kOnAxis = 1e-12;  // m: nearer, the direction would be rounding
  const Vector3d outward = rho > kOnAxis ? Vector3d(across / rho) : x_axis_;
  switch (kind_) {
    case Kind::cylinder:
      return {side_ * (rho - radius_), side_ * outward};
    case Kind::cone:
      return {side_ * cosine_ * (rho - radius_ - height * tangent_), side_ * (cosine_ * outward - sine_ * axis_)};
    default: {  // sphere: a torus whose ring has no radius
      const double q = rho - ring_;
      const double to_tube = std::sqrt(q * q + height * height);
      const Vector3d away = q * outward + height * axis_;
      return {side_ * (to_tube - radius_), to_tube > 0 ? Vector3d(side_ / to_tube * away) : Vector3d(side_ * outward)};
    }
  }
}

}  // namespace verisim::exact
