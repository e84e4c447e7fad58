// A curve seen from a surface: its distance from it, with the first two derivatives along the curve and the change
// within the step, in the surface's own axes, where a handful of multiplications are enough. The search's innermost
// loop, and the one place beside engine/geometry/analytic_surface.hpp that writes out the distance of each kind: fixed
// at compile time, without vectors, with derivatives that nobody else needs. tests/exact/meridian_test.cpp holds it
// against that one. Private to this folder.
#pragma once

#include <cmath>

#include "engine/exact/exact_body.hpp"

namespace verisim::exact {

/// p(t) = origin + c x + s y in coordinates (x axis, y axis, axis) of the surface, and the surface's numbers. Within
/// the step a place p of the curve moves by shift + turn x p.
struct CurveFromSurface {
  Vector3d origin, x, y, shift, turn;
  bool is_arc;
  Meridian surface;
  double side;
};

struct Measure {
  double distance;  ///< m
  double slope;     ///< by t
  double bend;      ///< second derivative by t
  double change;    ///< m, of the distance within the step
};

/// At one place, c and s as in ExactBody::sample_c. A sphere is a torus whose ring has no radius.
template <SurfaceKind kKind, bool kIsArc>
[[gnu::always_inline]] inline Measure measure(const CurveFromSurface& f, double c, double s) {
  // X, Y, Z: the place; T: first, B: second derivative.
  const double X = f.origin.x() + c * f.x.x() + s * f.y.x();
  const double Y = f.origin.y() + c * f.x.y() + s * f.y.y();
  const double Z = f.origin.z() + c * f.x.z() + s * f.y.z();
  const double TX = kIsArc ? c * f.y.x() - s * f.x.x() : f.x.x();
  const double TY = kIsArc ? c * f.y.y() - s * f.x.y() : f.x.y();
  const double TZ = kIsArc ? c * f.y.z() - s * f.x.z() : f.x.z();
  const double BX = kIsArc ? f.origin.x() - X : 0;
  const double BY = kIsArc ? f.origin.y() - Y : 0;
  const double BZ = kIsArc ? f.origin.z() - Z : 0;
  const double MX = f.shift.x() + f.turn.y() * Z;  // less what turns about the axis and so along the surface
  const double MY = f.shift.y() - f.turn.x() * Z;
  const double MZ = f.shift.z() + f.turn.x() * Y - f.turn.y() * X;
  if constexpr (kKind == SurfaceKind::plane) return {Z, TZ, BZ, MZ};
  const double rho = std::sqrt(X * X + Y * Y);
  const double per_rho = 1 / (rho + 1e-300);  // on the axis: no slope
  const double rho1 = (X * TX + Y * TY) * per_rho;
  const double rho2 = (TX * TX + TY * TY - rho1 * rho1 + X * BX + Y * BY) * per_rho;
  const double away = (X * MX + Y * MY) * per_rho;
  const Meridian& m = f.surface;
  if constexpr (kKind == SurfaceKind::cylinder)
    return {f.side * (rho - m.radius), f.side * rho1, f.side * rho2, f.side * away};
  if constexpr (kKind == SurfaceKind::cone) {
    return {f.side * m.cosine * (rho - m.radius - Z * m.tangent), f.side * (m.cosine * rho1 - m.sine * TZ),
            f.side * (m.cosine * rho2 - m.sine * BZ), f.side * (m.cosine * away - m.sine * MZ)};
  }
  const double q = rho - m.ring;
  const double tube = std::sqrt(q * q + Z * Z);
  const double per_tube = 1 / (tube + 1e-300);
  const double tube1 = (q * rho1 + Z * TZ) * per_tube;
  const double tube2 = (rho1 * rho1 + q * rho2 + TZ * TZ + Z * BZ - tube1 * tube1) * per_tube;
  return {f.side * (tube - m.radius), f.side * tube1, f.side * tube2, f.side * (q * away + Z * MZ) * per_tube};
}

/// @param shift, turn  of the curve within the step, in the coordinates of the surface's body
[[nodiscard]] inline CurveFromSurface seen_from(const PreciseSurface& s, const Vector3d& origin, const Vector3d& x,
                                                const Vector3d& y, bool is_arc, const Vector3d& shift,
                                                const Vector3d& turn) {
  return {s.to_own_axes(origin - s.point()),
          s.to_own_axes(x),
          s.to_own_axes(y),
          s.to_own_axes(shift + turn.cross(s.point())),
          s.to_own_axes(turn),
          is_arc,
          s.meridian(),
          s.side()};
}

/// Calls f with the measure of the curve's kinds as a function of (c, s).
template <typename F>
inline void with_measure(const CurveFromSurface& curve, F&& f) {
  const auto of_kind = [&]<SurfaceKind kKind>() {
    if (curve.is_arc) {
      f([&](double c, double s) { return measure<kKind, true>(curve, c, s); });
    } else {
      f([&](double c, double s) { return measure<kKind, false>(curve, c, s); });
    }
  };
  switch (curve.surface.kind) {
    case SurfaceKind::plane:
      return of_kind.template operator()<SurfaceKind::plane>();
    case SurfaceKind::cylinder:
      return of_kind.template operator()<SurfaceKind::cylinder>();
    case SurfaceKind::cone:
      return of_kind.template operator()<SurfaceKind::cone>();
    case SurfaceKind::sphere:
    case SurfaceKind::torus:
      return of_kind.template operator()<SurfaceKind::torus>();
  }
}

/// How near a segment comes to a surface if the distance is a parabola over it, less `growth` times t.
inline double nearest_of(const Measure& m, double half_width, double growth) {
  const double way = std::abs(m.slope - growth);
  const double to_end = m.bend * half_width > way ? way / m.bend : half_width;
  return m.distance - to_end * (way - 0.5 * m.bend * to_end);
}

}  // namespace verisim::exact
