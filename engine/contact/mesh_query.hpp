// Triangles against triangles by FCL: the comparator of the voxmap query (`contact = "fcl"`). Its contacts are in the
// same list, so the response is the same.
//
// FCL's contact of two intersecting triangles (0.7, collision/intersect-inl.h): the deepest corner of one triangle
// behind the other's plane, with that plane's normal and that depth; of the two choices the less deep one. At edges
// some depths reach through the whole part to a face around the edge. So a contact counts only if it is the shallowest
// of one of its two triangles, and of a corner's contacts only the shallowest counts. A body inside another touches
// nothing.
//
// Cost: milliseconds where query.hpp takes microseconds, and FCL allocates. Its answer is the same on every run.
#pragma once

#include <memory>

#include "engine/contact/query.hpp"
#include "engine/geometry/mesh.hpp"

namespace verisim {

/// A body's triangles with FCL's tree of oriented boxes over them; triangles without area are left out.
class MeshTree {
 public:
  /// @pre vertices are finite, corners are vertices
  explicit MeshTree(const TriangleMesh& mesh);
  ~MeshTree();
  MeshTree(const MeshTree&) = delete;
  MeshTree& operator=(const MeshTree&) = delete;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
  friend void query(const MeshTree& a, const MeshTree& b, const Pose& X_AB, const Vector3d& origin_A,
                    ContactList& contacts, QueryCost& cost);
};

/// Fills `contacts`, sorted by place: points relative to `origin_A`, normals that push B, body coordinates of A.
/// What goes beyond the list's capacity is left out and counted. `point` and `slot` are the triangles' numbers in B and
/// A. @pre origin_A is finite; the rotation is unit, if the pose is finite
void query(const MeshTree& a, const MeshTree& b, const Pose& X_AB, const Vector3d& origin_A, ContactList& contacts,
           QueryCost& cost);

}  // namespace verisim
