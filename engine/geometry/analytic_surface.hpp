// A surface with an equation, and what is asked of it: signed distance, gradient, curvature, nearest point, chart.
// Plane, cylinder, cone, sphere and torus are one shape: a meridian turned about an axis (a plane's: about its normal).
// Written here once; recovery, the voxels' association, exact contacts and declared features all ask here.
//
// Coordinates: those of the Surface (engine/geometry/entity.hpp) that it was made of, unless in_grid() changed them.
// Any unit of length, the same for all lengths: m, voxels in a grid. Angles in rad. A point's own coordinates are (x,
// y, h) along x axis, axis cross x axis and axis from `point()`; rho = sqrt(x^2 + y^2).
//
//   plane      d = h
//   cylinder   d = rho - r
//   cone       d = cos a (rho - r - h tan a)
//   sphere     d = sqrt(rho^2 + h^2) - r
//   torus      d = sqrt((rho - R)^2 + h^2) - r
//
// d is the distance of a point, positive outside of a round surface and where a plane's normal points, with two
// exceptions: nearer to a cone's apex than to its side, and near the axis beyond a place where a torus meets itself,
// the surface is farther away than |d|. Its gradient is unit everywhere; on the axis of a round surface (a sphere's
// centre, the ring in the middle of a tube), where d has a fold, it is one of the many there are.
//
// The surface has no bounds: which part of it belongs to a face is asked of engine/exact/trim.hpp and
// engine/voxel/trim.hpp.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "engine/geometry/entity.hpp"

namespace verisim {

/// The kinds of Surface that have an equation, from simple to general: of two that explain the same, the first is
/// meant.
enum class SurfaceKind : std::uint8_t { plane, cylinder, cone, sphere, torus };

// --- in the half plane of a meridian --------------------------------------------------------------------------------

/// The distance of a place (rho, h) and its gradient there, (out, up) / length by rho and h: left undivided, for who
/// needs a vector of three divides once.
struct MeridianAt {
  double distance;
  double out, up, length;
};

/// The curve that is turned about the axis: five numbers for all kinds. A fit may have signs that no Surface has.
struct Meridian {
  SurfaceKind kind = SurfaceKind::plane;
  double radius = 0;  ///< cylinder, sphere; torus: of the tube; cone: at h = 0
  double ring = 0;    ///< torus: of the circle that the tube's middle is; < 0: the inside of a tube wider than its ring
  double cosine = 1, sine = 0, tangent = 0;  ///< cone: of the half angle; sine and tangent < 0: narrowing with h

  [[nodiscard]] double distance(double rho, double h) const;
  [[nodiscard]] MeridianAt at(double rho, double h) const;

  /// No second derivative of d along a unit direction is larger than this, nowhere within `reach` of the place;
  /// infinity where a fold is that near.
  [[nodiscard]] double curvature_bound(double rho, double h, double reach) const;

  /// Where it meets the axis: a cone's apex; of a torus that meets itself the upper of two places, h and -h. 0 for
  /// others.
  /// @pre of a cone: tangent is not 0
  [[nodiscard]] double apex() const;

  /// The second parameter v of entity.hpp for a place of the surface: h [length], or the angle of a sphere or tube in
  /// (-pi, pi]. Of a plane, which has none along its meridian: h.
  [[nodiscard]] double parameter(double rho, double h) const;
};

// --- in space -------------------------------------------------------------------------------------------------------

/// A point seen from an axis.
struct Profile {
  double rho, height;  ///< from the axis and along it
  Vector3d outward;    ///< unit, from the axis
};

/// About 20 flops and one square root.
/// @param on_axis  () -> the direction to take for a point on the axis (within 1e-12), where none is outward
template <typename OnAxis>
[[nodiscard]] Profile profile_of(const Vector3d& p, const Vector3d& point, const Vector3d& axis, OnAxis on_axis);

class ArchiveReader;

/// The distance of one point from a face's surface and its gradient.
struct SurfaceAt {
  double distance;  ///< positive outside of the material
  Vector3d normal;  ///< out of the material, unit
};

class AnalyticSurface {
 public:
  /// Nothing for OtherSurface and for a surface that is none (fault_of in engine/geometry/entity_check.hpp). Of a torus
  /// that meets itself: its outside.
  [[nodiscard]] static std::optional<AnalyticSurface> from(const Surface& surface);
  /// The same; of a torus that meets itself the part, outside or inside, where the face is by its v range.
  [[nodiscard]] static std::optional<AnalyticSurface> from(const Face& face);
  /// The surface in coordinates (p - origin) * scale. @pre scale is finite and above 0, the origin finite
  [[nodiscard]] AnalyticSurface in_grid(const Vector3d& origin, double scale) const;

  /// About 40 flops and one square root, two for sphere and torus. On the axis of a round surface the normal is that of
  /// the x axis' direction.
  [[nodiscard]] SurfaceAt at(const Vector3d& p) const;

  /// The nearest point of the surface; where several are, one of them. About 60 flops.
  [[nodiscard]] Vector3d foot(const Vector3d& p) const;

  /// Meridian::curvature_bound at a point; with reach 0 it is infinite exactly where the normal is one of many.
  [[nodiscard]] double curvature_bound(const Vector3d& p, double reach) const;

  /// The parameters (u, v) of entity.hpp of a point of the surface; angles in (-pi, pi]. About 50 ns.
  [[nodiscard]] std::array<double, 2> parameters(const Vector3d& p) const;

  /// A chart of the surface for points of it, without trigonometry: plane (x, y); cylinder and cone (turn, height);
  /// sphere (turn, sine of the latitude); torus (turn, turn of the tube). Lengths as they are; a turn counts 0 to 4
  /// once around. About 10 ns.
  [[nodiscard]] std::array<double, 2> chart(const Vector3d& foot) const;

  /// A vector in the surface's own axes: x axis, axis cross x axis, axis.
  [[nodiscard]] Vector3d to_own_axes(const Vector3d& v) const { return {v.dot(x_axis_), v.dot(y_axis_), v.dot(axis_)}; }

  [[nodiscard]] SurfaceKind kind() const { return meridian_.kind; }
  [[nodiscard]] const Meridian& meridian() const { return meridian_; }
  [[nodiscard]] const Vector3d& point() const { return point_; }
  [[nodiscard]] const Vector3d& axis() const { return axis_; }
  [[nodiscard]] const Vector3d& x_axis() const { return x_axis_; }
  [[nodiscard]] const Vector3d& y_axis() const { return y_axis_; }
  [[nodiscard]] double side() const { return side_; }  ///< -1 for holes, else 1
  /// Material is inside (pin, ball), not around (hole). Planes: false.
  [[nodiscard]] bool is_convex() const { return meridian_.kind != SurfaceKind::plane && side_ > 0; }

  /// For engine/base/archive.hpp.
  static void fields(auto& archive, AnalyticSurface& self) {
    auto& [kind, radius, ring, cosine, sine, tangent] = self.meridian_;
    archive(kind, radius, ring, cosine, sine, tangent, self.point_, self.axis_, self.x_axis_, self.y_axis_, self.side_);
  }

 private:
  friend class ArchiveReader;
  AnalyticSurface() = default;
  [[nodiscard]] Profile profile(const Vector3d& p) const {
    return profile_of(p, point_, axis_, [this] { return x_axis_; });
  }

  Meridian meridian_;
  Vector3d point_ = Vector3d::Zero(), axis_ = Vector3d::UnitZ(), x_axis_ = Vector3d::UnitX(),
           y_axis_ = Vector3d::UnitY();
  double side_ = 1;
};

/// 0 to 4 once around: grows with the angle of (x, y) from the x axis, needs no trigonometry. 0 at the origin.
[[nodiscard]] double turn_of(double x, double y);

// --- inline: asked in the loops of exact contacts, association and recovery -----------------------------------------

inline double Meridian::distance(double rho, double h) const {
  switch (kind) {
    case SurfaceKind::plane:
      return h;
    case SurfaceKind::cylinder:
      return rho - radius;
    case SurfaceKind::cone:
      return cosine * (rho - radius - h * tangent);
    case SurfaceKind::sphere:  // a torus whose ring has no radius
    case SurfaceKind::torus:
      break;
  }
  const double q = rho - ring;
  return std::sqrt(q * q + h * h) - radius;
}

inline MeridianAt Meridian::at(double rho, double h) const {
  switch (kind) {
    case SurfaceKind::plane:
      return {h, 0, 1, 1};
    case SurfaceKind::cylinder:
      return {rho - radius, 1, 0, 1};
    case SurfaceKind::cone:
      return {cosine * (rho - radius - h * tangent), cosine, -sine, 1};
    case SurfaceKind::sphere:
    case SurfaceKind::torus:
      break;
  }
  const double q = rho - ring;
  const double to_middle = std::sqrt(q * q + h * h);
  if (!(to_middle > 0)) return {-radius, 1, 0, 1};
  return {to_middle - radius, q, h, to_middle};
}

inline double Meridian::curvature_bound(double rho, double h, double reach) const {
  const auto inverse = [&](double r) { return r > reach ? 1 / (r - reach) : std::numeric_limits<double>::infinity(); };
  switch (kind) {
    case SurfaceKind::plane:
      return 0;
    case SurfaceKind::cylinder:
      return inverse(rho);
    case SurfaceKind::cone:
      return cosine * inverse(rho);
    case SurfaceKind::sphere:
      return inverse(std::sqrt(rho * rho + h * h));
    case SurfaceKind::torus:
      break;
  }
  const double q = rho - ring;
  return std::max(inverse(std::sqrt(q * q + h * h)), inverse(rho));
}

template <typename OnAxis>
inline Profile profile_of(const Vector3d& p, const Vector3d& point, const Vector3d& axis, OnAxis on_axis) {
  constexpr double kOnAxis = 1e-12;  // nearer, the direction would be rounding
  const Vector3d arm = p - point;
  const double height = arm.dot(axis);
  const Vector3d across = arm - height * axis;
  const double rho = across.norm();
  return {rho, height, rho > kOnAxis ? Vector3d(across / rho) : Vector3d(on_axis())};
}

inline SurfaceAt AnalyticSurface::at(const Vector3d& p) const {
  if (meridian_.kind == SurfaceKind::plane) return {(p - point_).dot(axis_), axis_};
  const Profile f = profile(p);
  if (meridian_.kind == SurfaceKind::cylinder) {  // most faces that are round: no combination, no division
    return {side_ * meridian_.distance(f.rho, f.height), side_ * f.outward};
  }
  const MeridianAt m = meridian_.at(f.rho, f.height);
  return {side_ * m.distance, side_ / m.length * (m.out * f.outward + m.up * axis_)};
}

}  // namespace verisim
