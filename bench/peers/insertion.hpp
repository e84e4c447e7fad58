// The driven insertion of ../shared/reference/peers/README.md for every engine: shapes, the hand's pull, and how deep
// the pin is in the wall, in closed form from its pose.
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

constexpr int kWedges = 64;  ///< of a hole for engines without concave shapes: a polygon whose sides touch the circle
constexpr double kStep = 0.001;  ///< s
constexpr double kBlockHalf = 0.1875;

struct Motion {
  Pose X_WB;
  Vector3d v = Vector3d::Zero(), omega = Vector3d::Zero();  ///< world axes
};

/// The vertices of a wedge: a sector between the hole's polygon, chamfered at its upper rim, and the outer square.
[[nodiscard]] std::vector<Vector3d> wedge(int sector, double chamfer);

struct Mesh {
  std::vector<Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;  ///< counter-clockwise from outside
};
/// The block with that polygon as its hole, closed.
[[nodiscard]] Mesh block_mesh(double chamfer);

/// Deepest overlap of the pin's side with the round hole below its chamfer [m], at many angles: the pin's end circles
/// against the wall, the wall's end circles against the pin's side.
[[nodiscard]] double overlap_with_circle(const Pose& X, double radius, double chamfer);
/// The same with the wedges' inner faces: the pin's end circles against the faces, the faces' lower and upper edges
/// against the pin's side.
[[nodiscard]] double overlap_with_polygon(const Pose& X, double radius, double chamfer);

/// The pull of the hand on a peer's pin: the coupling of held_pin.hpp, evaluated at the step's start.
struct Coupling {
  double radius;
  [[nodiscard]] Vector3d inertia() const;
  [[nodiscard]] Wrench pull(const Hand& hand, const Motion& m) const;
};

}  // namespace verisim::peers
