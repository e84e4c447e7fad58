// Helpers of the recovery tests: parts as files have them, and results to compare to the last bit.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "engine/base/random.hpp"
#include "engine/geometry/part.hpp"

namespace verisim::testing {

/// The part as a binary STL file has it: triangles alone, in millimetres and single precision. Its `face_of_triangle`
/// goes to `drawn_face_of`, if that is given.
inline Part bare(const Part& part, std::vector<std::uint32_t>* drawn_face_of = nullptr) {
  Part result;
  result.name = part.name;
  result.mesh = part.mesh;
  for (Vector3d& p : result.mesh.vertices) p = 0.001 * (1000 * p).cast<float>().cast<double>();
  std::vector<std::string> notes;
  repair(result.mesh, notes);
  if (drawn_face_of != nullptr) *drawn_face_of = result.mesh.face_of_triangle;
  result.mesh.face_of_triangle.clear();
  return result;
}

/// Vertices and triangles in another order, triangles begun at other corners.
inline TriangleMesh shuffled(const TriangleMesh& mesh, std::uint64_t seed) {
  const RandomStream random(seed, "shuffle");
  std::uint64_t drawn = 0;
  const auto below = [&](std::size_t n) {
    return static_cast<std::size_t>(random.uniform(drawn++) * static_cast<double>(n));
  };
  std::vector<std::uint32_t> number(mesh.vertices.size());
  for (std::uint32_t i = 0; i < number.size(); ++i) number[i] = i;
  for (std::size_t i = number.size(); i > 1; --i) std::swap(number[i - 1], number[below(i)]);
  TriangleMesh result;
  result.vertices.resize(mesh.vertices.size());
  for (std::size_t i = 0; i < number.size(); ++i) result.vertices[number[i]] = mesh.vertices[i];
  for (const auto& [a, b, c] : mesh.triangles) {
    std::array<std::uint32_t, 3> t = {number[a], number[b], number[c]};
    std::rotate(t.begin(), t.begin() + static_cast<std::ptrdiff_t>(below(3)), t.end());
    result.triangles.push_back(t);
  }
  for (std::size_t i = result.triangles.size(); i > 1; --i) {
    std::swap(result.triangles[i - 1], result.triangles[below(i)]);
  }
  return result;
}

/// All numbers of faces and edges.
inline std::vector<std::byte> bytes_of(Part part) {
  part.mesh = {};
  std::vector<std::byte> bytes;
  for (const NamedArray& table : to_tables(part)) bytes.insert(bytes.end(), table.bytes.begin(), table.bytes.end());
  return bytes;
}

/// A slab 0.1 m wide whose upper side is wavy, above a plane; its sides are open.
inline TriangleMesh wavy_slab() {
  TriangleMesh mesh;
  constexpr std::uint32_t kSide = 24;
  for (std::uint32_t i = 0; i <= kSide; ++i) {
    for (std::uint32_t j = 0; j <= kSide; ++j) {
      const double x = 0.1 * i / kSide, y = 0.1 * j / kSide;
      mesh.vertices.emplace_back(x, y, 0.02 + 0.004 * std::sin(70 * x + 20 * y) * std::cos(45 * y - 13 * x));
      mesh.vertices.emplace_back(x, y, 0);
      if (i == kSide || j == kSide) continue;
      const std::uint32_t a = 2 * (i * (kSide + 1) + j), b = a + 2 * (kSide + 1), c = b + 2, d = a + 2;
      mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
      mesh.triangles.insert(mesh.triangles.end(), {{a + 1, c + 1, b + 1}, {a + 1, d + 1, c + 1}});
    }
  }
  return mesh;
}

/// A ring of tube, in quads of two triangles.
inline TriangleMesh ring_mesh(double major, double minor, std::uint32_t around, std::uint32_t along) {
  constexpr double kTurn = 2 * 3.14159265358979323846;
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < around; ++i) {
    for (std::uint32_t j = 0; j < along; ++j) {
      const double u = kTurn * i / around, v = kTurn * j / along;
      const double rho = major + minor * std::cos(v);
      mesh.vertices.emplace_back(rho * std::cos(u), rho * std::sin(u), minor * std::sin(v));
      const std::uint32_t i2 = (i + 1) % around, j2 = (j + 1) % along;
      const std::uint32_t a = i * along + j, b = i2 * along + j, c = i2 * along + j2, d = i * along + j2;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  }
  return mesh;
}

}  // namespace verisim::testing
