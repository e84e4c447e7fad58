// How deep one solid reaches into another: the largest distance to B's surface of the points of A's surface that lie
// within B (0 if none does). All points of A's surface count: faces, edges, rims, vertices.
//
// Branch and bound over A's surface, piece by piece, with bounds that hold for every point of a piece:
//  - Lipschitz: a point's depth changes by at most 1 m per m;
//  - of second order: the depth is at most the distance to the surface of any of B's faces whose nearest point there
//    is known to be B's own for all of the piece (the tree, with that surface forced to either side, has to change
//    sign by more than the piece can move it). Of these distances, and of the surfaces that cut A's face, linear models
//    with proven remainders give a small linear problem: the best of a few is the bound.
// The depth that is reported is that of a point that was found: no more than `bound` below the true one.
#pragma once

#include "engine/ruler/csg.hpp"
#include "engine/ruler/depth.hpp"

namespace verisim::ruler {

/// Of a's surface in b. About 2 us for each piece. @pre both in the same coordinates
[[nodiscard]] Depth depth_in(const Csg& a, const Csg& b, const Accuracy& accuracy);

/// Is one farther from the middle of the other than that reaches? Cheap; false says nothing.
[[nodiscard]] bool are_apart(const Csg& a, const Csg& b);

/// Distance of x to b's surface if x lies within b, else 0. Of edges and corners whose faces are curved the nearest
/// point is found by Newton's method, and right to second order in the depth over the radius.
[[nodiscard]] double depth_of(const Vector3d& x, const Csg& b);

}  // namespace verisim::ruler
