// The arithmetic of a query, defined once: where a cluster and a point lie in A's grid, which voxel that is and how
// deep. Private to this folder. Scalar; query_simd.cpp repeats `locate` and `depth_of` lane by lane in the same order.
//
// All coordinates are A's grid coordinates (voxels), split as base + local: `base` is the cell of the cluster's centre
// (integer), `local` the rest (float, a few voxels), so nothing is lost to the size of a part.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "engine/contact/query.hpp"

namespace verisim {

/// What stays the same for all points of one query. Matrices are row-major.
struct QueryFrame {
  float voxels[9];           ///< rotation B to A divided by the voxel size [voxel/m]
  float rotation[9];         ///< rotation B to A
  double centers[9];         ///< as `voxels`, for cluster centres
  double origin[3];          ///< the pointshell's reference [voxel]
  float voxel_size;          ///< m
  std::int32_t cell_max[3];  ///< last cell along each axis
  std::int32_t row, slice;   ///< bricks along x; bricks in an xy slice
  const std::uint32_t* brick_block;
  const Layer* brick_clearance;
  const Layer* layers;
};

/// A cluster that is not culled: its centre, in B and in A's grid.
struct ClusterFrame {
  float center[3];           ///< m, relative to the pointshell's reference
  std::int32_t base[3];      ///< cell of the centre
  float fraction[3];         ///< centre within that cell, in [0, 1]
  std::uint32_t begin, end;  ///< its points
};

/// Adding it to an integer |i| < 2^22 leaves i in the low bits of the float: a conversion that is one addition.
inline constexpr float kIntegerMagic = 0x1.8p23F;
inline constexpr std::int32_t kIntegerMagicBits = 0x4B400000;

/// A point in A's grid.
struct PointLocation {
  float local[3];      ///< relative to the cluster's base cell
  std::uint32_t slot;  ///< block * 512 + cell in brick, of the cell clamped to the grid
  Layer layer;
};

inline QueryFrame make_query_frame(const Voxmap& a, const Pointshell& b, const Pose& X_AB) {
  QueryFrame f{};
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

/// Written in place: a returned struct would be copied in wide loads of narrow stores, which the CPU has to wait for.
inline void place(const QueryFrame& f, const Pointshell::Cluster& cluster, ClusterFrame& c) {
  const double x = cluster.center.x();
  const double y = cluster.center.y();
  const double z = cluster.center.z();
  for (int i = 0; i < 3; ++i) {
    const double g = f.centers[3 * i] * x + f.centers[3 * i + 1] * y + f.centers[3 * i + 2] * z + f.origin[i];
    c.center[i] = cluster.center[i];
    c.base[i] = floor_limited(g);
    const double fraction = g - c.base[i];
    c.fraction[i] =
        fraction >= 0 && fraction <= 1 ? static_cast<float>(fraction) : 0.0F;  // beyond the limits: anything
  }
  c.begin = cluster.begin;
  c.end = cluster.end;
}

inline std::int32_t clamp_cell(std::int32_t cell, std::int32_t last) {
  return cell < 0 ? 0 : cell > last ? last : cell;
}

inline std::int32_t brick_of(const QueryFrame& f, const std::int32_t cell[3]) {
  return (cell[0] >> kBrickShift) + (cell[1] >> kBrickShift) * f.row + (cell[2] >> kBrickShift) * f.slice;
}

inline std::uint32_t slot_of(const QueryFrame& f, const std::int32_t cell[3]) {
  const std::int32_t in_brick = (cell[0] & 7) | (cell[1] & 7) << 3 | (cell[2] & 7) << 6;
  return f.brick_block[brick_of(f, cell)] << 9 | static_cast<std::uint32_t>(in_brick);
}

inline PointLocation locate(const QueryFrame& f, const ClusterFrame& c, float x, float y, float z) {
  PointLocation p{};
  const float dx = x - c.center[0];
  const float dy = y - c.center[1];
  const float dz = z - c.center[2];
  std::int32_t cell[3];
  for (int i = 0; i < 3; ++i) {
    p.local[i] = f.voxels[3 * i] * dx + f.voxels[3 * i + 1] * dy + f.voxels[3 * i + 2] * dz + c.fraction[i];
    const auto bits = std::bit_cast<std::int32_t>(std::floor(p.local[i]) + kIntegerMagic);
    cell[i] = clamp_cell(bits + (c.base[i] - kIntegerMagicBits), f.cell_max[i]);
  }
  p.slot = slot_of(f, cell);
  p.layer = f.layers[p.slot];
  return p;
}

/// Depth of a point in a voxel of layer <= 0 along the normal (nx, ny, nz), A's axes [m]; see query.hpp.
inline float depth_of(const QueryFrame& f, const PointLocation& p, float nx, float ny, float nz) {
  const float to_center_x = 0.5F - (p.local[0] - std::floor(p.local[0]));
  const float to_center_y = 0.5F - (p.local[1] - std::floor(p.local[1]));
  const float to_center_z = 0.5F - (p.local[2] - std::floor(p.local[2]));
  const float along = to_center_x * nx + to_center_y * ny + to_center_z * nz;
  return (along - static_cast<float>(p.layer)) * f.voxel_size;
}

}  // namespace verisim
