// The plain voxelizer that the fast one must equal: every voxel against every triangle, distances by search, sides by
// the solid angle that the mesh subtends. Slow; for small grids.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <vector>

#include "engine/voxel/voxelize.hpp"

namespace verisim::plain {

/// Winding number of a closed mesh about p: solid angles of its triangles (Van Oosterom and Strackee 1983) over 4 pi.
inline double winding_number(const TriangleMesh& mesh, const Vector3d& p) {
  double angle = 0;
  for (const auto& [ia, ib, ic] : mesh.triangles) {
    const Vector3d a = mesh.vertices[ia] - p, b = mesh.vertices[ib] - p, c = mesh.vertices[ic] - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    const double denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    angle += 2 * std::atan2(a.dot(b.cross(c)), denominator);
  }
  return angle / (4 * std::numbers::pi);
}

/// Layers of every cell of the map's grid, x fastest. Only origin, voxel_size and bricks of the map are read.
inline std::vector<int> layers(const TriangleMesh& mesh, const Voxmap& map) {
  const Eigen::Vector3i n = kBrickSide * map.bricks;
  const auto index = [&](const Eigen::Vector3i& c) {
    return static_cast<std::size_t>((c.z() * n.y() + c.y()) * n.x() + c.x());
  };
  std::vector<int> distance(static_cast<std::size_t>(n.prod()), kBand + 1);
  std::vector<Eigen::Vector3i> cells;
  for (int z = 0; z < n.z(); ++z) {
    for (int y = 0; y < n.y(); ++y) {
      for (int x = 0; x < n.x(); ++x) cells.emplace_back(x, y, z);
    }
  }
  for (const Eigen::Vector3i& cell : cells) {
    const bool touched = std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& t) {
      return triangle_touches_box(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]], map.center_of(cell),
                                  0.5 * map.voxel_size);
    });
    if (!touched) continue;
    const Eigen::Vector3i low = (cell.array() - kBand).max(0), high = (cell.array() + kBand).min(n.array() - 1);
    for (int z = low.z(); z <= high.z(); ++z) {
      for (int y = low.y(); y <= high.y(); ++y) {
        for (int x = low.x(); x <= high.x(); ++x) {
          int& known = distance[index({x, y, z})];
          known = std::min(known, (Eigen::Vector3i(x, y, z) - cell).cwiseAbs().maxCoeff());
        }
      }
    }
  }
  for (const Eigen::Vector3i& cell : cells) {
    int& layer = distance[index(cell)];
    if (layer > 0 && winding_number(mesh, map.center_of(cell)) > 0.5) layer = -layer;
  }
  return distance;
}

/// The same of a voxmap.
inline std::vector<int> layers(const Voxmap& map) {
  const Eigen::Vector3i n = kBrickSide * map.bricks;
  std::vector<int> result;
  for (int z = 0; z < n.z(); ++z) {
    for (int y = 0; y < n.y(); ++y) {
      for (int x = 0; x < n.x(); ++x) result.push_back(map.layer({x, y, z}));
    }
  }
  return result;
}

}  // namespace verisim::plain
