// Makes features (exact_body.hpp) of the edges, corners and round faces of a part. Body coordinates [m]. Private to
// this folder.
#pragma once

#include "engine/exact/exact_body.hpp"

namespace verisim::exact {

/// Points along an edge, ends included; empty for an edge without length. On lines, circles and ellipses the points lie
/// on the curve, at most `spacing` [m] apart and at least 16 segments to a turn. On other curves they are those of the
/// tessellation, projected onto the surfaces of the edge's faces.
/// @param first, second  those surfaces; null if not known
[[nodiscard]] std::vector<Vector3d> points_along(const Edge& edge, double spacing, const PreciseSurface* first,
                                                 const PreciseSurface* second);

/// Adds the samples of an edge. A concave edge has none: it cannot touch anything.
/// @param side_sign  side_sign[i] (tangent x normal of face i) points out of that face
void add_edge_features(ExactBody& body, const Edge& edge, const ExactEdge& made, const std::vector<Vector3d>& points,
                       const std::array<double, 2>& side_sign);

/// Adds the features of a convex round face: a sphere's centre, a torus' ring, a pin's axis, a cone's axis and apex.
void add_face_features(ExactBody& body, const Face& face, std::uint32_t number);

/// One end of an edge, for add_corners.
struct EdgeEnd {
  Vector3d point;
  Vector3d into;                    ///< unit, along the edge and away from its end
  std::uint32_t edge;               ///< number in ExactBody::edges
  std::size_t which;                ///< 0: its beginning, 1: its end
  std::array<Vector3d, 2> outward;  ///< unit, leaves either face across the edge; zero: not known
};
/// Finds the corners, points where three or more edges end (to 1e-7 m). Sets limits_beyond_end of those edges, and adds
/// a point feature where all of them are convex.
void add_corners(ExactBody& body, std::vector<EdgeEnd> ends);

/// The box around the balls of a block of samples.
[[nodiscard]] Bounds bounds_of(const ExactBody& body, const SampleBlock& block);

}  // namespace verisim::exact
