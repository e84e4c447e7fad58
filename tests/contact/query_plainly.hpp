// The contact query written plainly: a loop over all points, nothing culled, no SIMD. What the engine's must equal bit
// for bit. Costs differ: it counts every point.
#pragma once

#include <bit>
#include <cstdint>

#include "engine/contact/query.hpp"
#include "engine/contact/query_arithmetic.hpp"

namespace verisim::test {

/// A point in A's grid.
struct PointLocation {
  float local[3];      ///< from the centre of the cluster's base cell
  float to_center[3];  ///< from here to the centre of its own cell
  std::uint32_t slot;  ///< block * 512 + cell in brick, of the cell clamped to the grid
  Layer layer;
};

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

inline void query_plainly(const Voxmap& a, const Pointshell& b, const Pose& X_AB, ContactList& contacts,
                          QueryCost& cost) {
  contacts.size = 0;
  const QueryConstants f = make_query_constants(a, b, X_AB);
  for (const Pointshell::Cluster& cluster : b.clusters) {
    PlacedCluster c;
    place(cluster, center_of(f, cluster), c);
    for (std::uint32_t i = c.begin; i < c.end; ++i) {
      const PointLocation p = locate(f, c, b.x[i], b.y[i], b.z[i]);
      if (p.layer > 0) continue;
      ++cost.candidates;
      float n[3];
      for (int r = 0; r < 3; ++r) {
        n[r] = f.rotation[3 * r] * b.nx[i] + f.rotation[3 * r + 1] * b.ny[i] + f.rotation[3 * r + 2] * b.nz[i];
      }
      const float depth = depth_of(f, p, n[0], n[1], n[2]);
      if (!(depth > 0)) continue;
      const std::uint32_t k = contacts.size++;
      contacts.point[k] = i;
      contacts.slot[k] = p.slot;
      contacts.x[k] = coordinate(f, c.base[0], p.local[0]);
      contacts.y[k] = coordinate(f, c.base[1], p.local[1]);
      contacts.z[k] = coordinate(f, c.base[2], p.local[2]);
      contacts.nx[k] = n[0];
      contacts.ny[k] = n[1];
      contacts.nz[k] = n[2];
      contacts.depth[k] = depth;
    }
  }
  cost.clusters += b.clusters.size();
  cost.points += b.size();
}

}  // namespace verisim::test
