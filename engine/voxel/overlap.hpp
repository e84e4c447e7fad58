// Overlap test of a triangle and a box: one box, or 8 x 8 x 8 of them at once. Grid coordinates (unit: one voxel).
//
// Source: separating axes of triangle and box (Akenine-Möller 2001): three box axes, the triangle's normal, nine
// products of an edge and a box axis. Each of the nine lies in a coordinate plane, so for a lattice of boxes they are
// three flat 8 x 8 patterns, and the 512 answers are the patterns' product.
//
// All three corners are projected on every axis. So an axis may be rounded badly (the normal of a sliver): it may fail
// to separate, but it never separates a triangle from a box that it touches.
#pragma once

#include "engine/base/pose.hpp"
#include "engine/voxel/brick_mask.hpp"

namespace verisim {

/// Outward tolerance of the overlap test relative to a box's half side. Far above the rounding of grid coordinates
/// (below 2^-30 for a million voxels along an axis), far below the resolution of a voxel.
inline constexpr double kTouchTolerance = 0x1p-20;

/// Boxes that only gather candidates are grown by this much [voxel], so that every finer test finds its triangles
/// there.
inline constexpr double kCandidateMargin = 0x1p-10;

/// 512 boxes: centres at corner + (i + 1/2) side, i = 0..7 along each axis.
struct BoxLattice {
  Vector3d corner;   ///< lower corner of the lattice [voxel]
  double side;       ///< spacing of the boxes [voxel]
  double half_side;  ///< half a box's side, tolerance included [voxel]; boxes may overlap
};

/// One triangle, prepared for many tests.
class TriangleOverlap {
 public:
  TriangleOverlap(const Vector3d& a, const Vector3d& b, const Vector3d& c);

  /// The boxes that the closed triangle touches. 0.1 to 1 us.
  [[nodiscard]] BrickMask touched(const BoxLattice& lattice) const;

  [[nodiscard]] const Vector3d& lower() const { return lower_; }
  [[nodiscard]] const Vector3d& upper() const { return upper_; }

 private:
  /// An axis in the plane of coordinates (u, v) and the triangle's extent along it.
  struct FlatAxis {
    double u, v, low, high;
  };
  struct Range {
    int begin, end;
  };

  [[nodiscard]] static Range overlapped(double low, double high, double corner, const BoxLattice& lattice);
  [[nodiscard]] std::uint64_t pattern(int plane, const BoxLattice& lattice, Range u, Range v) const;
  void keep_near_plane(const BoxLattice& lattice, const std::array<Range, 3>& range, BrickMask& mask) const;

  Vector3d lower_, upper_;
  Vector3d normal_;
  double normal_low_, normal_high_;
  std::array<std::array<FlatAxis, 3>, 3> axes_;  // per plane (xy, yz, xz): one per edge
};

}  // namespace verisim
