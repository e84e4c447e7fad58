// The driven insertion of ../shared/reference/peers/README.md for every engine: shapes, the hand's pull, and what it is
// judged by: how deep the pin is in the wall, in closed form from its pose, and the force that holds it at rest.
#pragma once

#include <array>
#include <vector>

#include "engine/base/pose.hpp"
#include "tests/exact/driven_insertion.hpp"

namespace verisim::peers {

using exact::test::Hand;
using exact::test::hand_at;
using exact::test::Insertion;
using exact::test::kBlockHeight;
using exact::test::kHoleRadius;
using exact::test::kPinLength;
using exact::test::Start;

constexpr int kWedges = 64;  ///< of an insertion's hole without concave shapes: a polygon whose sides touch the circle
constexpr double kStep = 0.001;  ///< s
constexpr double kBlockHalf = 0.1875;

struct Motion {
  Pose X_WB;
  Vector3d v = Vector3d::Zero(), omega = Vector3d::Zero();  ///< world axes
};

/// How the block is cut into convex wedges.
struct Cut {
  double chamfer = 0;    ///< m
  int wedges = kWedges;  ///< a multiple of 8: the square's corners are vertices
  double drawn_in = 0;   ///< m: faces that can be touched lie so far inside, for an engine that adds a margin around
};
/// The vertices of a wedge: a sector between the hole's polygon, chamfered at its upper rim, and the outer square.
/// First those of one side, from the hole's lower edge up and around, then those of the other in the same order.
/// @pre chamfer is 0 or above drawn_in
[[nodiscard]] std::vector<Vector3d> wedge(int sector, const Cut& cut);

struct Mesh {
  std::vector<Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;  ///< counter-clockwise from outside
};
/// The block with a polygon of so many sides as its hole, closed. @pre sides is a multiple of 8
[[nodiscard]] Mesh block_mesh(double chamfer, int sides = kWedges);

/// How deep the pin's side is in the wall of the round hole below its chamfer [m], at many angles: the pin's end
/// circles against the wall, the wall's end circles against the pin's side. Below 0: minus the gap. @pre an end is in
/// the hole
[[nodiscard]] double depth_in_circle(const Pose& X, double radius, double chamfer);
/// The same, 0 where there is no overlap.
[[nodiscard]] double overlap_with_circle(const Pose& X, double radius, double chamfer);
/// The same with the wedges' inner faces: the pin's end circles against the faces, the faces' lower and upper edges
/// against the pin's side.
[[nodiscard]] double overlap_with_polygon(const Pose& X, double radius, double chamfer);

/// The contact force [N, world] on a rigid pin that hangs at rest on the hand of the insertion's end, without friction.
///
/// Hand, hole and pin share the plane of z and the hand's offset. In it the pin's axis is the line n.p = w with
/// n = (cos a, -sin a), a the tilt. A corner of the hole at (x, z) is beside the pin if |n.(x, z) - w| >= r: so
///   -(R cos a - H/2 sin a - r) <= w <= R cos a - (H/2 - chamfer) sin a - r.
/// Along its axis the pin is free; across it the hand's spring k is longer by what these bounds take. The tilt is where
/// the sum of that energy and of kappa (a_hand - a)^2 / 2 is least. A polygon's sides are further out by up to 1.1 um
/// where this pin touches them: 6 mN.
/// @pre what holds the pin does not saturate: the clearance leaves no more than 20 mm and 5 deg to the springs
[[nodiscard]] Vector3d force_at_rest(const Insertion& task);

/// The pull of the hand on a peer's pin: the coupling of held_pin.hpp, evaluated at the step's start.
struct Coupling {
  double radius;
  [[nodiscard]] Vector3d inertia() const;
  [[nodiscard]] Wrench pull(const Hand& hand, const Motion& m) const;
};

}  // namespace verisim::peers
