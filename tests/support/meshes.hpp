// What tests do to meshes, whatever they are of.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>

#include "engine/geometry/mesh.hpp"

namespace verisim::test {

/// The triangles of `other` behind those of `mesh`.
inline void append(TriangleMesh& mesh, const TriangleMesh& other) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& [i, j, k] : other.triangles) mesh.triangles.push_back({first + i, first + j, first + k});
}

inline TriangleMesh turned_inside_out(TriangleMesh mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

/// Every triangle in four at its edge midpoints; the shape is the same. Midpoints of shared edges are shared.
inline TriangleMesh subdivide(const TriangleMesh& mesh) {
  TriangleMesh fine;
  fine.vertices = mesh.vertices;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> midpoint_of_edge;
  const auto midpoint = [&](std::uint32_t i, std::uint32_t j) {
    const auto [entry, is_new] =
        midpoint_of_edge.try_emplace(std::minmax(i, j), static_cast<std::uint32_t>(fine.vertices.size()));
    if (is_new) fine.vertices.emplace_back(0.5 * (mesh.vertices[i] + mesh.vertices[j]));
    return entry->second;
  };
  for (const auto& [i, j, k] : mesh.triangles) {
    const std::uint32_t ij = midpoint(i, j), jk = midpoint(j, k), ki = midpoint(k, i);
    fine.triangles.insert(fine.triangles.end(), {{i, ij, ki}, {ij, j, jk}, {ki, jk, k}, {ij, jk, ki}});
  }
  for (const std::uint32_t face : mesh.face_of_triangle)
    fine.face_of_triangle.insert(fine.face_of_triangle.end(), 4, face);
  return fine;
}

}  // namespace verisim::test
