// The arithmetic of a query: where a cluster lies in A's grid, and what is needed to find its points' voxels. Private
// to this folder. Scalar; query_simd.cpp goes on from here lane by lane, point by point. Its steps are written plainly,
// in the same order, in tests/contact/query_plainly.hpp, whose bits it must equal.
//
// All coordinates are A's grid coordinates (voxels), split as base + 1/2 + local: `base` is the cell of the cluster's
// centre (integer), `local` the way from that cell's centre (float, a few voxels), so nothing is lost to the size of a
// part, and the nearest integer to `local` leads to the centre of the point's own voxel. A point exactly on the wall
// between two voxels is given to one of them by the rounding of ties, the same one everywhere.
#pragma once

#include <cmath>
#include <cstdint>

#include "engine/contact/query.hpp"

namespace verisim {

/// Constants of one query. Matrices are row-major.
struct QueryConstants {
  float voxels[9];           ///< rotation B to A divided by the voxel size [voxel/m]
  float rotation[9];         ///< rotation B to A
  double centers[9];         ///< as `voxels`, for cluster centres
  double origin[3];          ///< the pointshell's reference [voxel]
  float voxel_size;          ///< m
  std::int32_t cell_max[3];  ///< last cell along each axis
  std::int32_t row, slice;   ///< bricks along x; bricks in an xy slice
  std::int32_t bricks[3];    ///< along each axis
  const std::uint32_t* brick_block;
  const Layer* brick_clearance;
  const Layer* layers;
};

/// A cluster that is not culled: its centre, in B and in A's grid.
struct PlacedCluster {
  float center[3];           ///< m, relative to the pointshell's reference
  std::int32_t base[3];      ///< cell of the centre
  std::int32_t corner[3];    ///< first cell of the 3 x 3 x 3 bricks around it
  float local[3];            ///< the centre itself, in [-1/2, 1/2]
  float rounder[3];          ///< kRounder + base - corner
  std::uint32_t begin, end;  ///< its points
  bool near;                 ///< all points lie within kBrickSide cells of the base
};

/// Added to a float below 2^22 in magnitude, it leaves the nearest integer in the low bits of the sum; subtracted
/// again, it leaves that integer as a float. So rounding and conversion are one addition, the same on every target. If
/// a whole number is added to it, the bits hold the sum of both.
inline constexpr float kRounder = 0x1.8p23F;
inline constexpr std::int32_t kRounderBits = 0x4B400000;

inline QueryConstants make_query_constants(const Voxmap& a, const Pointshell& b, const Pose& X_AB) {
  QueryConstants f{};
  const Matrix3d R = X_AB.rotation.toRotationMatrix();
  const double per_metre = 1 / a.voxel_size;
  const Vector3d origin = (X_AB * b.reference - a.origin) * per_metre;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      f.centers[3 * i + j] = R(i, j) * per_metre;
      f.voxels[3 * i + j] = static_cast<float>(R(i, j) * per_metre);
      f.rotation[3 * i + j] = static_cast<float>(R(i, j));
    }
    f.origin[i] = origin[i];
    f.bricks[i] = a.bricks[i];
    f.cell_max[i] = a.bricks[i] * kBrickSide - 1;
  }
  f.voxel_size = static_cast<float>(a.voxel_size);
  f.row = a.bricks.x();
  f.slice = a.bricks.x() * a.bricks.y();
  f.brick_block = a.brick_block.data();
  f.brick_clearance = a.brick_clearance.data();
  f.layers = a.layers.data();
  return f;
}

/// Largest integer not above g, of a finite or infinite g; limited to what leaves room for a cluster's extent.
/// Written out because the C library's floor is a call on the x86-64 baseline.
inline std::int32_t floor_limited(double g) {
  constexpr double kLimit = 1 << 28;
  const double limited = g > -kLimit ? (g < kLimit ? g : kLimit) : -kLimit;  // NaN goes to -kLimit: far outside
  const auto truncated = static_cast<std::int32_t>(limited);
  return truncated - static_cast<std::int32_t>(static_cast<double>(truncated) > limited);
}

/// Centre of a cluster [voxel].
struct Center {
  double x, y, z;
};

inline Center center_of(const QueryConstants& f, const Pointshell::Cluster& cluster) {
  const double x = cluster.center.x();
  const double y = cluster.center.y();
  const double z = cluster.center.z();
  const double* m = f.centers;
  return {m[0] * x + m[1] * y + m[2] * z + f.origin[0], m[3] * x + m[4] * y + m[5] * z + f.origin[1],
          m[6] * x + m[7] * y + m[8] * z + f.origin[2]};
}

/// Along axis i; g: the centre [voxel].
inline void place_axis(double g, int i, PlacedCluster& c) {
  c.base[i] = floor_limited(g);
  c.corner[i] = ((c.base[i] >> kBrickShift) - 1) * kBrickSide;
  c.rounder[i] = kRounder + static_cast<float>(c.base[i] - c.corner[i]);
  const double local = g - c.base[i] - 0.5;
  c.local[i] = std::abs(local) <= 0.5 ? static_cast<float>(local) : 0.0F;  // beyond the limits: anything
}

/// Written in place: a returned struct would be copied in wide loads of narrow stores, which the CPU has to wait for.
inline void place(const Pointshell::Cluster& cluster, const Center& center, PlacedCluster& c) {
  for (int i = 0; i < 3; ++i) c.center[i] = cluster.center[i];
  place_axis(center.x, 0, c);
  place_axis(center.y, 1, c);
  place_axis(center.z, 2, c);
  c.begin = cluster.begin;
  c.end = cluster.end;
}

inline std::int32_t clamp_cell(std::int32_t cell, std::int32_t last) {
  return cell < 0 ? 0 : cell > last ? last : cell;
}

inline std::int32_t brick_of(const QueryConstants& f, const std::int32_t cell[3]) {
  return (cell[0] >> kBrickShift) + (cell[1] >> kBrickShift) * f.row + (cell[2] >> kBrickShift) * f.slice;
}

inline std::uint32_t slot_of(const QueryConstants& f, const std::int32_t cell[3]) {
  const std::int32_t in_brick = (cell[0] & 7) | (cell[1] & 7) << 3 | (cell[2] & 7) << 6;
  return f.brick_block[brick_of(f, cell)] << 9 | static_cast<std::uint32_t>(in_brick);
}

}  // namespace verisim
