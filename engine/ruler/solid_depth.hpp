// How deep one solid reaches into another: the largest distance to B's surface of the points of A's surface that lie
// within B (0 if none does). All points of A's surface count: faces, edges, rims, vertices.
//
// Branch and bound over A's surface, piece by piece, with bounds that hold for every point of a piece:
//  - Lipschitz: a point's depth changes by at most 1 m per m;
//  - by cells (cell_limit.hpp): what is outside of B is a union of cells, each the common part of sides of B's
//  surfaces.
//    The depth is no more than the distance to any of them. A convex cell is farthest from a corner of a flat piece; of
//    one or two surfaces that keep a piece out of a cell linear models with proven remainders say how far (patch.hpp;
//    coaxial.hpp where both are round about nearly the same axis). So conforming faces need no more pieces than others.
// Of a piece only that is looked at which A's own other surfaces leave, and which can be within B.
// The depth that is reported is that of a point that was found: no more than `bound` below the true one.
#pragma once

#include "engine/ruler/csg.hpp"
#include "engine/ruler/depth.hpp"

namespace verisim::ruler {

/// Of a's surface in b. About 5 us for each piece of simple solids, ten times that of those with a hundred surfaces.
/// @pre both in the same coordinates
[[nodiscard]] Depth depth_in(const Csg& a, const Csg& b, const Accuracy& accuracy);

/// Is one farther from the middle of the other than that reaches? Cheap; false says nothing.
[[nodiscard]] bool are_apart(const Csg& a, const Csg& b);

/// Distance of x to b's surface if x lies within b, else 0. Of edges and corners whose faces are curved the nearest
/// point is found by Newton's method, and right to second order in the depth over the radius.
[[nodiscard]] double depth_of(const Vector3d& x, const Csg& b);

}  // namespace verisim::ruler
