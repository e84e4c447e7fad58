// Closing of seams that are closed in space but not in the triangles' corner numbers: corners that differ by rounding,
// and T-joints (a corner of one triangle within another's side). Many exporters write both.
#pragma once

#include <vector>

#include "engine/geometry/mesh_edges.hpp"

namespace verisim {

// Of the two that close: @pre `open` is open_sides(mesh), of the mesh as it is; vertices are finite; the tolerance is
// finite and not negative.

/// The sides without a second triangle, in the order of sorted_sides. Only they and their ends take part in the
/// closing: a closed mesh stays as it is, however fine its details.
[[nodiscard]] std::vector<Side> open_sides(const TriangleMesh& mesh);

/// Merges ends of open sides that lie within `tolerance` [m] of each other into one of them. Triangles may then have
/// two equal corners. n log n, unless the ends lie in a plane across their box's longest direction.
/// @returns the number of vertices merged away
std::size_t join_near_corners(TriangleMesh& mesh, const std::vector<Side>& open, double tolerance);

/// Cuts every triangle at the ends of open sides that lie within `tolerance` [m] of one of its own open sides and
/// farther than that from its ends. No corner moves, and the pieces belong to the triangle's face. A triangle whose
/// third corner lies on that side too has no area: it is dropped, and its two other sides replace the open side. One
/// side of each triangle is treated; call again until nothing changes.
/// @param open  open_sides(mesh)
/// @returns the number of triangles cut or dropped
std::size_t cut_at_joints(TriangleMesh& mesh, const std::vector<Side>& open, double tolerance);

}  // namespace verisim
