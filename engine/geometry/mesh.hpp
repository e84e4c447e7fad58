// Triangle meshes: the tessellated representation of a part. Part coordinates [m].
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "engine/base/pose.hpp"

namespace verisim {

inline constexpr std::uint32_t kNoFace = std::numeric_limits<std::uint32_t>::max();

struct TriangleMesh {              //  shape  unit  meaning
  std::vector<Vector3d> vertices;  //  (n)    m     shared corners
  std::vector<std::array<std::uint32_t, 3>>
      triangles;                                //  (m)    -     counter-clockwise seen from outside the material
  std::vector<std::uint32_t> face_of_triangle;  //  (m)    -     index of the b-rep face, kNoFace; empty = no b-rep
};

struct Bounds {
  Vector3d min = Vector3d::Constant(std::numeric_limits<double>::infinity());
  Vector3d max = Vector3d::Constant(-std::numeric_limits<double>::infinity());
  void include(const Vector3d& p) {
    min = min.cwiseMin(p);
    max = max.cwiseMax(p);
  }
  [[nodiscard]] Vector3d size() const { return max - min; }
  [[nodiscard]] Vector3d center() const { return 0.5 * (min + max); }
};

/// Does the mesh hang together: are all corners of triangles vertices, and do all triangles or none know their face?
/// What everything that takes a mesh relies on; readers of files see to it.
[[nodiscard]] inline bool is_whole(const TriangleMesh& mesh) {
  for (const auto& triangle : mesh.triangles) {
    if (std::max({triangle[0], triangle[1], triangle[2]}) >= mesh.vertices.size()) return false;
  }
  return mesh.face_of_triangle.empty() || mesh.face_of_triangle.size() == mesh.triangles.size();
}

/// Of the corners that triangles use. @pre is_whole(mesh), here and in the two below
[[nodiscard]] Bounds bounds_of(const TriangleMesh& mesh);

/// Volume [m^3], centroid [m] and inertia about the centroid per unit density [m^5]. Exact for exact geometry, that of
/// the polyhedron for a mesh.
struct MassProperties {
  double volume = 0;
  Vector3d centroid = Vector3d::Zero();
  Matrix3d inertia = Matrix3d::Zero();
};

/// Of the solid that a closed, consistently oriented mesh bounds (signed tetrahedra, summed in triangle order).
[[nodiscard]] MassProperties mass_properties_of(const TriangleMesh& mesh);
[[nodiscard]] double area_of(const TriangleMesh& mesh);

/// Defects of a mesh: what must be repaired before it bounds a solid.
struct MeshReport {
  std::size_t degenerate_triangles = 0;  ///< repeated corners or zero area
  std::size_t duplicate_triangles = 0;
  std::size_t open_edges = 0;          ///< edges with one triangle
  std::size_t nonmanifold_edges = 0;   ///< edges with more than two
  std::size_t misoriented_edges = 0;   ///< edges whose two triangles run the same way
  std::size_t self_intersections = 0;  ///< pairs of triangles that cross (CGAL)
  std::size_t components = 0;
  bool inside_out = false;            ///< closed, but bounds a negative volume
  bool not_finite = false;            ///< NaN or infinity among the vertices
  Vector3d where = Vector3d::Zero();  ///< near the first open or non-manifold edge
  [[nodiscard]] bool watertight() const {
    return open_edges == 0 && nonmanifold_edges == 0 && misoriented_edges == 0 && !inside_out && !not_finite;
  }
};

/// Repairs a mesh in place, face_of_triangle with it. Welds equal vertices, drops degenerate and duplicate triangles,
/// closes seams and T-joints, and orients components consistently and outward (nested shells alternately). T-joints:
/// where a corner lies on another triangle's open edge, to 1e-6 of the mesh's diagonal, that triangle is cut there.
/// Ends of open edges within the same distance become one. Wider gaps stay open. Every repair is one sentence in
/// `notes`.
/// @returns the report of the mesh as it is afterwards.
/// @pre is_whole(mesh)
MeshReport repair(TriangleMesh& mesh, std::vector<std::string>& notes);

/// The report alone. Self-intersections are looked for if `thorough` (n log n; CGAL). @pre is_whole(mesh)
[[nodiscard]] MeshReport examine(const TriangleMesh& mesh, bool thorough);

}  // namespace verisim
