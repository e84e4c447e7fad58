// The unbounded surface of a face in grid coordinates (unit: one voxel): whether it passes through a box, and points of
// it there, in closed form.
//
// The surface is the zero set of its distance function (engine/geometry/analytic_surface.hpp), whose slope is one at
// most: a connected box is met where the function changes its sign or is zero. All but the torus's are convex: their
// largest value in a box is at a corner; the smallest is on an edge of the box, or where the axis enters it. The torus
// is searched by halving boxes until slope and curvature decide.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "engine/geometry/analytic_surface.hpp"
#include "engine/voxel/grid_curve.hpp"

namespace verisim {

class GridSurface {
 public:
  /// Grid coordinates are (p - origin) * scale. Nothing for a face whose surface has no equation.
  [[nodiscard]] static std::optional<GridSurface> from(const Face& face, const Vector3d& origin, double scale);

  [[nodiscard]] SurfaceKind kind() const { return surface_.kind(); }
  [[nodiscard]] const Meridian& meridian() const { return surface_.meridian(); }
  /// Rows: the surface's x, y and z axis. Local coordinates of p are axes (p - origin).
  [[nodiscard]] const Matrix3d& axes() const { return axes_; }
  [[nodiscard]] const Vector3d& origin() const { return origin_; }
  [[nodiscard]] Vector3d to_local(const Vector3d& p) const { return axes_ * (p - origin_); }
  [[nodiscard]] Vector3d to_grid(const Vector3d& local) const { return origin_ + axes_.transpose() * local; }

  /// The distance function at a point in local coordinates, whatever side the material is on.
  [[nodiscard]] double value(const Vector3d& local) const;

  /// The nearest point of the surface, grid coordinates.
  [[nodiscard]] Vector3d foot(const Vector3d& p) const { return surface_.foot(p); }

  /// Does the surface pass through the closed box? 5 ns for planes, 15 ns for others, up to some us where only the
  /// exact extremes tell.
  [[nodiscard]] bool touches(const GridBox& box) const;

  /// Is the part of the surface within `distance` of `center` one sheet: curved so little that it cannot leave a ball
  /// of that radius and come back?
  [[nodiscard]] bool is_one_sheet(const Vector3d& center, double distance) const;

  /// Adds points of the surface in the closed box (local coordinates): at least one of every connected piece that the
  /// box cuts out of the surface.
  void add_probes(const GridBox& box, std::vector<Vector3d>& probes) const;

 private:
  explicit GridSurface(const AnalyticSurface& placed);

  [[nodiscard]] std::optional<bool> touches_by_slope(const Vector3d& local, double rho, const MeridianAt& at,
                                                     double half) const;
  [[nodiscard]] bool sphere_touches(const GridBox& box) const;
  [[nodiscard]] bool convex_touches(const GridBox& box) const;
  [[nodiscard]] bool torus_touches(const GridBox& box, std::array<bool, 2>& signs) const;
  [[nodiscard]] double lowest_on_line(const Vector3d& local, const Vector3d& step, double half) const;
  template <class Visit>
  void for_each_axis_entry(const GridBox& box, Visit visit) const;
  void add_roots(const GridBox& box, const Vector3d& start, int axis, std::vector<Vector3d>& probes) const;
  void add_torus_roots(const Vector3d& local, const Vector3d& step, double half, std::vector<Vector3d>& probes) const;
  void add_extremes(const GridBox& box, std::vector<Vector3d>& probes) const;

  AnalyticSurface surface_;  // in grid coordinates
  Vector3d origin_;
  Matrix3d axes_;
  double plane_extent_;  // of a plane: sum of its normal's absolute components
};

}  // namespace verisim
