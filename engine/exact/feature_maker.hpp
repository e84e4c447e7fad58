// How edges, corners and round faces of a part become features (exact_body.hpp). Private to this folder.
#pragma once

#include "engine/exact/exact_body.hpp"

namespace verisim::exact {

/// Points along the edge, ends included, at most `spacing` [m] apart on lines, circles and ellipses (there exact, at
/// least 16 segments to a turn); on other curves those of the tessellation, put onto the surfaces of the edge's faces
/// as far as `first` and `second` are known. Empty for an edge without length.
[[nodiscard]] std::vector<Vector3d> points_along(const Edge& edge, double spacing, const PreciseSurface* first,
                                                 const PreciseSurface* second);

/// The samples of an edge that can touch something: not those of a concave edge. `side_sign[i]` makes
/// tangent x normal of face i point out of that face.
void add_edge_features(ExactBody& body, const Edge& edge, const ExactEdge& made, const std::vector<Vector3d>& points,
                       const std::array<double, 2>& side_sign);

/// A ball's middle, a torus' ring, a pin's axis, a cone's axis and apex.
void add_face_features(ExactBody& body, const Face& face, std::uint32_t number);

/// One edge's end, for take_corners.
struct EdgeEnd {
  Vector3d point;
  Vector3d into;                   ///< unit, along the edge
  std::uint32_t edge;              ///< number in ExactBody::edges
  std::size_t which;               ///< 0: its beginning, 1: its end
  std::array<Vector3d, 2> out_of;  ///< unit, out of either face across the edge; zero: not known
};
/// Points where three or more edges end: for which faces the edges speak for what is beyond, and, where all of the
/// edges are convex, features.
void take_corners(ExactBody& body, std::vector<EdgeEnd> ends);

/// The box around a run's balls.
[[nodiscard]] Bounds bounds_of(const ExactBody& body, const Run& run);

}  // namespace verisim::exact
