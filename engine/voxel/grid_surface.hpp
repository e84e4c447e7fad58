// The unbounded surface of a face in grid coordinates (unit: one voxel): on which side a point is, whether the surface
// passes through a box, and points of it there, in closed form.
//
// Every surface is the zero set of a function with slope at most one: plane z, cylinder rho - r, cone
// cos a (rho - r) - sin a z, sphere |p| - r, torus |(rho - R, z)| - r (with -R on the inside of a tube wider than
// its ring), in the face's own frame (z its axis or normal,
// rho the distance from it). A connected box is met where the function changes its sign or is zero. All but the torus's
// are convex: their largest value in a box is at a corner; the smallest is on an edge of the box, or where the axis
// enters it. The torus is searched by halving boxes until slope and curvature decide.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/geometry/entity.hpp"
#include "engine/voxel/grid_curve.hpp"

namespace verisim {

class GridSurface {
 public:
  enum class Shape { plane, cylinder, cone, sphere, torus, other };

  /// Grid coordinates are (p - origin) * scale. Of a torus that meets itself, the part outside or the part inside,
  /// where the face is. A surface with a number that is not finite or a radius that is negative is `other`.
  GridSurface(const Face& face, const Vector3d& origin, double scale);

  [[nodiscard]] Shape shape() const { return shape_; }
  /// Rows: the frame's x, y and z axis. Local coordinates of p are axes (p - origin).
  [[nodiscard]] const Matrix3d& axes() const { return axes_; }
  [[nodiscard]] const Vector3d& origin() const { return origin_; }
  [[nodiscard]] Vector3d to_local(const Vector3d& p) const { return axes_ * (p - origin_); }
  [[nodiscard]] double major_radius() const { return radius_; }

  /// The function above at a point in local coordinates: the signed distance from the surface, but for points nearer
  /// to a cone's apex than to its side, where it is nearer to zero.
  [[nodiscard]] double value(const Vector3d& local) const;

  /// Does the surface pass through the closed box? 5 ns for planes, 15 ns for others, up to some us where only the
  /// exact extremes tell.
  [[nodiscard]] bool touches(const GridBox& box) const;

  /// Is the part of the surface within `distance` of `center` one sheet: curved so little that it cannot leave a ball
  /// of that radius and come back?
  [[nodiscard]] bool is_one_sheet(const Vector3d& center, double distance) const;

  /// Adds points of the surface in the closed box (local coordinates): at least one of every connected piece that the
  /// box cuts out of the surface.
  void add_probes(const GridBox& box, std::vector<Vector3d>& probes) const;

  /// The point of the surface nearest to p, both in local coordinates.
  [[nodiscard]] Vector3d projected(const Vector3d& local) const;

 private:
  [[nodiscard]] Vector3d gradient(const Vector3d& local) const;
  [[nodiscard]] double curvature_bound(const Vector3d& local, double distance) const;
  [[nodiscard]] bool sphere_touches(const GridBox& box) const;
  [[nodiscard]] bool convex_touches(const GridBox& box) const;
  [[nodiscard]] bool torus_touches(const GridBox& box, std::array<bool, 2>& signs) const;
  [[nodiscard]] double axis_meeting() const;
  [[nodiscard]] double lowest_on_line(const Vector3d& local, const Vector3d& step, double half) const;
  template <class Visit>
  void for_each_axis_entry(const GridBox& box, Visit visit) const;
  void add_roots(const GridBox& box, const Vector3d& start, int axis, std::vector<Vector3d>& probes) const;
  void add_torus_roots(const Vector3d& local, const Vector3d& step, double half, std::vector<Vector3d>& probes) const;
  void add_extremes(const GridBox& box, std::vector<Vector3d>& probes) const;

  Shape shape_ = Shape::other;
  Vector3d origin_ = Vector3d::Zero();
  Matrix3d axes_ = Matrix3d::Identity();
  double radius_ = 0;             // of a torus: the major one
  double minor_ = 0;              // of a torus
  double sine_ = 0, cosine_ = 1;  // of a cone's half angle
  double plane_extent_ = 0;       // of a plane: sum of its normal's absolute components
};

}  // namespace verisim
