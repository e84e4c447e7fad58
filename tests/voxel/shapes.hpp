// Watertight meshes with known answers, made here so that the voxel tests depend on no other folder. Lengths in metres;
// triangles counter-clockwise seen from outside.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "engine/base/pinned_math.hpp"
#include "engine/geometry/mesh.hpp"
#include "tests/support/meshes.hpp"

namespace verisim::shapes {

using Quad = std::array<std::uint32_t, 4>;

inline void add_quad(TriangleMesh& mesh, const Quad& q) {
  mesh.triangles.push_back({q[0], q[1], q[2]});
  mesh.triangles.push_back({q[0], q[2], q[3]});
}

inline TriangleMesh box(const Vector3d& low, const Vector3d& high) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back((i & 1) != 0 ? high.x() : low.x(), (i & 2) != 0 ? high.y() : low.y(),
                               (i & 4) != 0 ? high.z() : low.z());
  }
  for (const Quad& q : {Quad{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    add_quad(mesh, q);
  }
  return mesh;
}

/// `mesh` and `other` side by side in one mesh.
inline TriangleMesh both(TriangleMesh mesh, const TriangleMesh& other) {
  test::append(mesh, other);
  return mesh;
}

template <class Map>
TriangleMesh mapped(TriangleMesh mesh, const Map& map) {
  for (Vector3d& p : mesh.vertices) p = map(p);
  return mesh;
}

inline std::array<double, 2> on_circle(int i, int facets) {
  const double angle = 2 * std::numbers::pi * i / facets;
  return {pinned::cos(angle), pinned::sin(angle)};
}

/// A closed profile of (distance from z, z) turned about z; counter-clockwise around the material, and nowhere on z.
inline TriangleMesh turned(const std::vector<std::array<double, 2>>& profile, int facets) {
  TriangleMesh mesh;
  const auto n = static_cast<std::uint32_t>(profile.size());
  const auto around = static_cast<std::uint32_t>(facets);
  for (std::uint32_t k = 0; k < around; ++k) {
    const auto [c, s] = on_circle(static_cast<int>(k), facets);
    for (const auto& [rho, z] : profile) mesh.vertices.emplace_back(rho * c, rho * s, z);
  }
  for (std::uint32_t k = 0; k < around; ++k) {
    const std::uint32_t here = k * n, there = (k + 1) % around * n;
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t j = (i + 1) % n;
      add_quad(mesh, {here + i, there + i, there + j, here + j});
    }
  }
  return mesh;
}

/// A prism of n facets inscribed in the cylinder of the given radius about z, from z = 0 to `height`.
inline TriangleMesh cylinder(double radius, double height, int facets) {
  TriangleMesh mesh;
  const auto n = static_cast<std::uint32_t>(facets);
  for (const double z : {0.0, height}) {
    for (int i = 0; i < facets; ++i) {
      const auto [c, s] = on_circle(i, facets);
      mesh.vertices.emplace_back(radius * c, radius * s, z);
    }
  }
  mesh.vertices.emplace_back(0, 0, 0);
  mesh.vertices.emplace_back(0, 0, height);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    add_quad(mesh, {i, j, j + n, i + n});
    mesh.triangles.push_back({2 * n, j, i});
    mesh.triangles.push_back({2 * n + 1, i + n, j + n});
  }
  return mesh;
}

/// A block centred at the origin with a through hole of n facets along z. @pre facets is a multiple of 4
inline TriangleMesh block_with_hole(const Vector3d& size, double radius, int facets) {
  TriangleMesh mesh;
  const auto n = static_cast<std::uint32_t>(facets);
  for (const double z :
       {-0.5 * size.z(), 0.5 * size.z()}) {  // a ring of the hole, then the same rays on the block's edge
    for (int i = 0; i < facets; ++i) {
      const auto [c, s] = on_circle(i, facets);
      mesh.vertices.emplace_back(radius * c, radius * s, z);
    }
    for (int i = 0; i < facets; ++i) {
      const int side = facets / 4, corner = (i + side / 2) / side % 4, along = (i + side / 2) % side;
      const double t = size.x() * (static_cast<double>(along) / side - 0.5);  // from corner to corner
      const double h = 0.5 * size.x();
      const std::array<std::array<double, 2>, 4> edge = {{{h, t}, {-t, h}, {-h, -t}, {t, -h}}};
      const auto& [x, y] = edge[static_cast<std::size_t>(corner)];
      mesh.vertices.emplace_back(x, y * size.y() / size.x(), z);
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    const std::uint32_t top = 2 * n;
    add_quad(mesh, {j, i, top + i, top + j});                      // the hole's wall
    add_quad(mesh, {n + i, n + j, top + n + j, top + n + i});      // the outer sides
    add_quad(mesh, {i, j, n + j, n + i});                          // bottom
    add_quad(mesh, {top + i, top + n + i, top + n + j, top + j});  // top
  }
  return mesh;
}

/// The block of the dissertation's trial.
inline TriangleMesh trial_block(int facets = 128) {
  return block_with_hole({0.375, 0.375, 0.2}, 0.075, facets);
}

/// An octahedron refined `times` times, its corners on the sphere about the origin.
inline TriangleMesh sphere(double radius, int times) {
  TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    mesh.vertices.emplace_back(Vector3d::Unit(axis));
    mesh.vertices.emplace_back(-Vector3d::Unit(axis));
  }
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int i = 0; i < times; ++i) mesh = test::subdivide(mesh);
  return mapped(std::move(mesh), [&](const Vector3d& p) { return Vector3d(radius * p.normalized()); });
}

/// A box whose upper edge along y is cut off at 45 degrees.
inline TriangleMesh chamfered(const Vector3d& size, double chamfer) {
  TriangleMesh mesh;
  const double x = size.x(), z = size.z();
  const std::array<std::array<double, 2>, 5> profile = {{{0, 0}, {x, 0}, {x, z - chamfer}, {x - chamfer, z}, {0, z}}};
  for (const double y : {0.0, size.y()}) {
    for (const auto& [px, pz] : profile) mesh.vertices.emplace_back(px, y, pz);
  }
  for (std::uint32_t i = 0; i < 5; ++i) add_quad(mesh, {(i + 1) % 5, i, i + 5, (i + 1) % 5 + 5});
  for (std::uint32_t i = 1; i < 4; ++i) {
    mesh.triangles.push_back({0, i, i + 1});
    mesh.triangles.push_back({5, 5 + i + 1, 5 + i});
  }
  return mesh;
}

/// Volume [m^3] that the mesh bounds; positive if its triangles look outward.
inline double volume(const TriangleMesh& mesh) {
  double six_times = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    six_times += mesh.vertices[a].dot(mesh.vertices[b].cross(mesh.vertices[c]));
  }
  return six_times / 6;
}

}  // namespace verisim::shapes
