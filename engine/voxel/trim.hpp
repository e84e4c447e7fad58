// Is a point of a face's surface within the face? Exactly, from the curves that bound it.
//
// A path on the surface from the point to one that is known to be within crosses the bounds an even number of times if
// the point is within too. The path has two legs that lie in planes, so that crossings are those of curves with planes:
// first at constant height around the axis (on a plane: along x) to the known point's meridian (its x), then along that
// meridian, whose crossings are known beforehand. (Why contacts ask engine/exact/trim.hpp instead stands there.)
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "engine/voxel/grid_curve.hpp"
#include "engine/voxel/grid_surface.hpp"

namespace verisim {

class FaceTrim {
 public:
  /// @param bounds    curves that bound the face, in the surface's local coordinates; no seams
  /// @param within    points of the surface, in local coordinates, that are well within the face; the first that the
  ///                  others agree with becomes the known one
  /// @param epsilon   the ends of the curves meet to this [voxel]
  /// @param surface   outlives this
  FaceTrim(const GridSurface& surface, std::vector<GridCurve> bounds, const std::vector<Vector3d>& within,
           double epsilon);

  /// No known point was found: the bounds do not close or do not lie on the surface. contains() may not be asked.
  [[nodiscard]] bool is_loose() const { return !has_reference_; }

  /// @param local  a point of the surface, farther than a few epsilon from every bound. About 10 ns per bound that
  ///               the first leg's plane crosses. No answer: bounds run along every path that was tried.
  [[nodiscard]] std::optional<bool> contains(const Vector3d& local) const;

 private:
  [[nodiscard]] std::optional<bool> ask(const Vector3d& local, double nudge) const;
  [[nodiscard]] bool set_reference(const Vector3d& local);
  [[nodiscard]] double height(const Vector3d& local) const;
  [[nodiscard]] bool same_branch(const Vector3d& a, const Vector3d& b) const;
  [[nodiscard]] bool on_first_leg(const Vector3d& from, const Vector3d& crossing) const;

  const GridSurface& surface_;
  std::vector<GridCurve> bounds_;
  std::vector<std::array<double, 2>> extents_;  // of the bounds along the first leg's normal
  double epsilon_;
  Vector3d leg_normal_;  // of the first leg's plane
  Vector3d reference_ = Vector3d::Zero();
  std::vector<double> meridian_;  // heights at which bounds cross the reference's meridian
  bool has_reference_ = false;
};

}  // namespace verisim
