// The curve that a polyline between two faces stands for.
#pragma once

#include <vector>

#include "engine/geometry/entity.hpp"
#include "engine/geometry/recover.hpp"

namespace verisim::recover {

/// Sets curve, t_range and length of an edge from its polyline; the edge is closed if its last point is its first. In
/// this order: the circle or ellipse in which the two surfaces meet, a line, a circle through the points, another
/// curve. Two or three points are an arc only if the surfaces say so.
/// @param beside     the surfaces on both sides, or one
/// @param tolerance  m, of points from the curve
/// @pre the polyline has two points or more; no surface is null; the tolerance is finite and above 0
void set_curve(Edge& edge, const std::vector<const Surface*>& beside, double tolerance,
               const RecoverThresholds& thresholds);

}  // namespace verisim::recover
