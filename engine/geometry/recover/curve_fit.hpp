// The curve that a polyline stands for.
#pragma once

#include <vector>

#include "engine/geometry/entity.hpp"

namespace verisim::recover {

/// Sets curve, t_range and length of an edge from its polyline (closed if its last point is its first): a line, a
/// circle, where a plane cuts a cylinder an ellipse, or another curve. A round surface beside it says that two or three
/// points are those of an arc. @param tolerance  m, of points from the curve
void set_curve(Edge& edge, const std::vector<const Surface*>& beside, double tolerance);

}  // namespace verisim::recover
