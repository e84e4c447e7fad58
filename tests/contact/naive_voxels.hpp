// Voxel bodies of shapes with a known distance function, built slowly and plainly: what tests of contact need, without
// the voxelizer whose own tests stand elsewhere.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>

#include "engine/voxel/voxmap.hpp"

namespace verisim::naive {

/// Body coordinates: the origin is the middle of the shape's bounding box. Lengths in m.
struct Shape {
  Vector3d half_sides;                              ///< of the bounding box
  std::function<double(const Vector3d&)> distance;  ///< signed, negative inside; slope at most 1
};

inline Shape box(const Vector3d& half) {
  return {half, [half](const Vector3d& p) {
            const Vector3d q = p.cwiseAbs() - half;
            return q.cwiseMax(0).norm() + std::min(q.maxCoeff(), 0.0);
          }};
}

inline Shape cylinder(double radius, double height) {
  return {{radius, radius, height / 2}, [=](const Vector3d& p) {
            const Eigen::Vector2d q(std::hypot(p.x(), p.y()) - radius, std::abs(p.z()) - height / 2);
            return q.cwiseMax(0).norm() + std::min(q.maxCoeff(), 0.0);
          }};
}

/// A block with a round hole along z through its middle.
inline Shape block_with_hole(const Vector3d& half, double radius) {
  const Shape block = box(half);
  return {half, [=](const Vector3d& p) { return std::max(block.distance(p), radius - std::hypot(p.x(), p.y())); }};
}

inline Vector3d inward(const Shape& shape, const Vector3d& p, double step) {
  Vector3d n;
  for (int i = 0; i < 3; ++i) {
    const Vector3d d = step * Vector3d::Unit(i);
    n[i] = shape.distance(p - d) - shape.distance(p + d);
  }
  return n.norm() > 0 ? n.normalized() : Vector3d::UnitZ();
}

/// Does the surface pass through the closed box? Decided on 5 x 5 x 5 of its points.
inline bool is_surface(const Shape& shape, const Vector3d& center, double side) {
  if (std::abs(shape.distance(center)) > 0.867 * side) return false;  // half the diagonal
  bool inside = false;
  bool outside = false;
  for (int i = 0; i < 125; ++i) {
    const Vector3d offset(i % 5 - 2, i / 5 % 5 - 2, i / 25 - 2);
    const double d = shape.distance(center + side / 4 * offset);
    inside = inside || d <= 1e-9 * side;  // a face in a voxel wall marks both sides
    outside = outside || d >= -1e-9 * side;
    if (inside && outside) return true;
  }
  return false;
}

/// The dense grid that the sparse map is made from.
struct Dense {
  Eigen::Vector3i cells;
  std::vector<Layer> layers;
  [[nodiscard]] std::size_t at(int x, int y, int z) const {
    return static_cast<std::size_t>(x) +
           static_cast<std::size_t>(cells.x()) * (y + static_cast<std::size_t>(cells.y()) * z);
  }
};

/// Steps to the nearest surface voxel, up to kBand + 1, from 0 and kBand + 1: two sweeps over the 26 neighbours.
inline void spread_steps(Dense& grid) {
  const auto sweep = [&](int sign) {
    for (int k = 0; k < grid.cells.prod(); ++k) {
      const int i = sign > 0 ? k : grid.cells.prod() - 1 - k;
      const int x = i % grid.cells.x();
      const int y = i / grid.cells.x() % grid.cells.y();
      const int z = i / grid.cells.x() / grid.cells.y();
      Layer& layer = grid.layers[static_cast<std::size_t>(i)];
      for (int n = 0; n < 13; ++n) {  // the neighbours that the sweep has passed
        const int u = x + sign * (n % 3 - 1);
        const int v = y + sign * (n / 3 % 3 - 1);
        const int w = z + sign * (n / 9 - 1);
        if (u < 0 || v < 0 || w < 0 || u >= grid.cells.x() || v >= grid.cells.y() || w >= grid.cells.z()) continue;
        layer = std::min<Layer>(layer, static_cast<Layer>(grid.layers[grid.at(u, v, w)] + 1));
      }
    }
  };
  sweep(+1);
  sweep(-1);
}

inline Dense sample(const Shape& shape, const Voxmap& map) {
  Dense grid{map.bricks * kBrickSide, {}};
  grid.layers.resize(static_cast<std::size_t>(grid.cells.prod()));
  const auto each = [&](const auto& visit) {
    for (int z = 0; z < grid.cells.z(); ++z) {
      for (int y = 0; y < grid.cells.y(); ++y) {
        for (int x = 0; x < grid.cells.x(); ++x) visit(grid.layers[grid.at(x, y, z)], map.center_of({x, y, z}));
      }
    }
  };
  each([&](Layer& l, const Vector3d& p) { l = is_surface(shape, p, map.voxel_size) ? 0 : kBand + 1; });
  spread_steps(grid);
  each([&](Layer& l, const Vector3d& p) { l = shape.distance(p) < 0 ? static_cast<Layer>(-l) : l; });
  return grid;
}

inline void fill_clearance(Voxmap& map, const std::vector<bool>& has_surface) {
  const Eigen::Vector3i n = map.bricks;
  const auto coordinates = [&](int i) { return Eigen::Vector3i(i % n.x(), i / n.x() % n.y(), i / n.x() / n.y()); };
  for (int i = 0; i < n.prod(); ++i) {
    int nearest = 127;
    for (int j = 0; j < n.prod(); ++j) {
      if (has_surface[static_cast<std::size_t>(j)]) {
        nearest = std::min(nearest, (coordinates(i) - coordinates(j)).cwiseAbs().maxCoeff());
      }
    }
    const auto block = map.brick_block[static_cast<std::size_t>(i)];
    const bool inside = map.layers[std::size_t{block} * kBrickCells] < 0;
    map.brick_clearance[static_cast<std::size_t>(i)] = static_cast<Layer>(inside ? -nearest : nearest);
  }
}

inline void close_cluster(Pointshell& shell, std::uint32_t begin) {
  const auto end = static_cast<std::uint32_t>(shell.size());
  if (begin == end) return;
  Eigen::AlignedBox3f bounds;
  for (std::uint32_t i = begin; i < end; ++i) bounds.extend(Vector3f(shell.x[i], shell.y[i], shell.z[i]));
  float radius = 0;
  for (std::uint32_t i = begin; i < end; ++i) {
    radius = std::max(radius, (Vector3f(shell.x[i], shell.y[i], shell.z[i]) - bounds.center()).norm());
  }
  shell.clusters.push_back({begin, end, bounds.center(), radius * 1.00001F});
}

/// One brick of the dense grid into the map (and its surface voxels into the shell). Returns whether it has any.
inline bool add_brick(const Shape& shape, const Dense& grid, const Eigen::Vector3i& brick, VoxelBody& body) {
  Voxmap& map = body.voxmap;
  Pointshell& shell = body.shell;
  std::array<Layer, kBrickCells> cells;
  std::array<std::uint64_t, 8> mask{};
  const auto begin = static_cast<std::uint32_t>(shell.size());
  for (int i = 0; i < kBrickCells; ++i) {
    const Eigen::Vector3i cell = brick * kBrickSide + Eigen::Vector3i(i & 7, i >> 3 & 7, i >> 6);
    cells[static_cast<std::size_t>(i)] = grid.layers[grid.at(cell.x(), cell.y(), cell.z())];
    if (cells[static_cast<std::size_t>(i)] != 0) continue;
    mask[static_cast<std::size_t>(i >> 6)] |= std::uint64_t{1} << (i & 63);
    const Vector3d p = map.center_of(cell);
    const Vector3d n = inward(shape, p, map.voxel_size / 8);
    const Vector3f q = (p - shell.reference).cast<float>();
    shell.x.push_back(q.x()), shell.y.push_back(q.y()), shell.z.push_back(q.z());
    const Vector3f m = n.cast<float>();
    shell.nx.push_back(m.x()), shell.ny.push_back(m.y()), shell.nz.push_back(m.z());
  }
  const bool uniform = std::all_of(cells.begin(), cells.end(), [&](Layer l) { return l == cells[0]; });
  if (uniform && std::abs(cells[0]) > kBand) {
    map.brick_block.push_back(cells[0] > 0 ? kOutsideBlock : kInsideBlock);
    return false;
  }
  map.brick_block.push_back(static_cast<std::uint32_t>(map.surface_mask.size()));
  map.layers.insert(map.layers.end(), cells.begin(), cells.end());
  map.surface_mask.push_back(mask);
  map.first_surface.push_back({begin});
  for (std::size_t z = 1; z < mask.size(); ++z) {
    map.first_surface.back()[z] = map.first_surface.back()[z - 1] + count_bits(mask[z - 1]);
  }
  close_cluster(shell, begin);
  return begin != shell.size();
}

inline VoxelBody voxelize(const Shape& shape, double voxel_size) {
  VoxelBody body;
  Voxmap& map = body.voxmap;
  Pointshell& shell = body.shell;
  map.voxel_size = voxel_size;
  for (int i = 0; i < 3; ++i) {
    map.bricks[i] = static_cast<int>(std::ceil((2 * shape.half_sides[i] / voxel_size + 2) / kBrickSide)) + 2;
  }
  map.origin = -0.5 * voxel_size * kBrickSide * map.bricks.cast<double>();
  const Dense grid = sample(shape, map);
  map.layers.assign(2 * kBrickCells, Layer{kBand + 1});
  std::fill(map.layers.begin() + kBrickCells, map.layers.end(), Layer{-kBand - 1});
  map.surface_mask.resize(2);
  map.first_surface.resize(2);
  std::vector<bool> has_surface;
  for (int i = 0; i < map.bricks.prod(); ++i) {
    const Eigen::Vector3i brick(i % map.bricks.x(), i / map.bricks.x() % map.bricks.y(),
                                i / map.bricks.x() / map.bricks.y());
    has_surface.push_back(add_brick(shape, grid, brick, body));
  }
  map.surface_count = static_cast<std::uint32_t>(shell.size());
  map.brick_clearance.resize(map.brick_block.size());
  fill_clearance(map, has_surface);
  return body;
}

}  // namespace verisim::naive
