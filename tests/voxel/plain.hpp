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

/// Calls visit(cell) for the cells from low to high, x fastest.
template <class Visit>
void for_each_cell(const Eigen::Vector3i& low, const Eigen::Vector3i& high, Visit visit) {
  for (int z = low.z(); z <= high.z(); ++z) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int x = low.x(); x <= high.x(); ++x) visit(Eigen::Vector3i(x, y, z));
    }
  }
}

/// Is a voxel surface? Every triangle is asked, but for those whose bounding box is more than a voxel away.
inline bool is_surface(const TriangleMesh& mesh, const Voxmap& map, const Eigen::Vector3i& cell) {
  const Vector3d center = map.center_of(cell);
  return std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& t) {
    const Vector3d &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const bool near = ((a.cwiseMin(b).cwiseMin(c) - center).array() < map.voxel_size).all() &&
                      ((center - a.cwiseMax(b).cwiseMax(c)).array() < map.voxel_size).all();
    return near && triangle_touches_box(a, b, c, center, 0.5 * map.voxel_size);
  });
}

/// Layers of every cell of the map's grid, x fastest. Only origin, voxel_size and bricks of the map are read.
inline std::vector<int> layers(const TriangleMesh& mesh, const Voxmap& map) {
  const Eigen::Vector3i n = kBrickSide * map.bricks, last = n.array() - 1;
  const auto index = [&](const Eigen::Vector3i& c) {
    return static_cast<std::size_t>((c.z() * n.y() + c.y()) * n.x() + c.x());
  };
  std::vector<int> result(static_cast<std::size_t>(n.prod()), kBand + 1);
  for_each_cell(Eigen::Vector3i::Zero(), last, [&](const Eigen::Vector3i& cell) {
    if (!is_surface(mesh, map, cell)) return;
    for_each_cell((cell.array() - kBand).max(0), (cell.array() + kBand).min(last.array()), [&](const auto& other) {
      int& distance = result[index(other)];
      distance = std::min(distance, (other - cell).cwiseAbs().maxCoeff());
    });
  });
  for_each_cell(Eigen::Vector3i::Zero(), last, [&](const Eigen::Vector3i& cell) {
    int& layer = result[index(cell)];
    if (layer > 0 && winding_number(mesh, map.center_of(cell)) > 0.5) layer = -layer;
  });
  return result;
}

/// Number of surface voxels of the map's grid, without brick, hierarchy or mask: every triangle against every voxel of
/// its bounding box. For grids of up to some 10^9 cells.
inline std::size_t surface_count(const TriangleMesh& mesh, const Voxmap& map) {
  const Eigen::Matrix<std::size_t, 3, 1> n = (kBrickSide * map.bricks).cast<std::size_t>();
  std::vector<bool> is_set(n.prod());
  std::size_t count = 0;
  for (const auto& t : mesh.triangles) {
    const Vector3d &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const Eigen::Vector3i low = map.cell_of(a.cwiseMin(b).cwiseMin(c)).array() - 1;
    const Eigen::Vector3i high = map.cell_of(a.cwiseMax(b).cwiseMax(c)).array() + 1;
    for_each_cell(low, high, [&](const Eigen::Vector3i& cell) {
      if (!triangle_touches_box(a, b, c, map.center_of(cell), 0.5 * map.voxel_size)) return;
      const Eigen::Matrix<std::size_t, 3, 1> at = cell.cast<std::size_t>();
      const std::size_t index = (at.z() * n.y() + at.y()) * n.x() + at.x();
      if (!is_set[index]) ++count;
      is_set[index] = true;
    });
  }
  return count;
}

/// The same of a voxmap.
inline std::vector<int> layers(const Voxmap& map) {
  std::vector<int> result;
  const Eigen::Vector3i last = (kBrickSide * map.bricks).array() - 1;
  for_each_cell(Eigen::Vector3i::Zero(), last, [&](const auto& cell) { result.push_back(map.layer(cell)); });
  return result;
}

}  // namespace verisim::plain
