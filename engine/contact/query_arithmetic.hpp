// The arithmetic of a query, defined once: position of a cluster and a point in A's grid, voxel and depth. Private to
// this folder. Scalar; query_simd.cpp repeats `locate` and `depth_of` lane by lane in the same order.
//
// All coordinates are A's grid coordinates (voxels), split as base + 1/2 + local: `base` is the cell of the cluster's
// centre (integer), `local` the way from that cell's centre (float, a few voxels), so nothing is lost to the size of a
// part, and the nearest integer to `local` leads to the centre of the point's own voxel. A point exactly on the wall
// between two voxels is given to one of them by the rounding of ties, the same one everywhere.
#pragma once

#include <bit>
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

/// A point in A's grid.
struct PointLocation {
  float local[3];      ///< from the centre of the cluster's base cell
  float to_center[3];  ///< from here to the centre of its own cell
  std::uint32_t slot;  ///< block * 512 + cell in brick, of the cell clamped to the grid
  Layer layer;
};

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

inline PointLocation locate(const QueryConstants& f, const PlacedCluster& c, float x, float y, float z) {
  PointLocation p{};
  const float dx = x - c.center[0];
  const float dy = y - c.center[1];
  const float dz = z - c.center[2];
  std::int32_t cell[3];
  for (int i = 0; i < 3; ++i) {
    p.local[i] = f.voxels[3 * i] * dx + f.voxels[3 * i + 1] * dy + f.voxels[3 * i + 2] * dz + c.local[i];
    const float rounded = p.local[i] + c.rounder[i];
    p.to_center[i] = (rounded - c.rounder[i]) - p.local[i];
    cell[i] = clamp_cell(std::bit_cast<std::int32_t>(rounded) - kRounderBits + c.corner[i], f.cell_max[i]);
  }
  p.slot = slot_of(f, cell);
  p.layer = f.layers[p.slot];
  return p;
}

/// Depth of a point in a voxel of layer <= 0 along the normal (nx, ny, nz), A's axes [m]; see query.hpp.
inline float depth_of(const QueryConstants& f, const PointLocation& p, float nx, float ny, float nz) {
  const float along = p.to_center[0] * nx + p.to_center[1] * ny + p.to_center[2] * nz;
  return (along - static_cast<float>(p.layer)) * f.voxel_size;
}

/// Coordinate of a point from A's grid origin along one axis [m].
inline float coordinate(const QueryConstants& f, std::int32_t base, float local) {
  return ((static_cast<float>(base) + 0.5F) + local) * f.voxel_size;
}

}  // namespace verisim
