// Normals beside the closest one of a hollow: what they hold does not go to and fro. A body's place is a point within
// the hollow shrunk by the body; its force is found from the planes alone.
#include "engine/exact/conforming_normals.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <vector>

namespace verisim::exact::test::conforming_normals_test {
namespace {

/// A plane that holds the point at a distance of 1 from the middle.
struct Plane {
  Vector3d normal;
  double stiffness;
};

const Vector3d kClosest = Vector3d::UnitX();
const Vector3d kBeside = Vector3d::UnitY();

std::vector<Plane> planes_of(const ConformingNormals& around) {
  std::vector<Plane> planes{{kClosest, around.part_of_closest}};
  for (std::size_t i = 0; i < around.count; ++i) planes.push_back({around.normals[i], around.parts[i]});
  return planes;
}

std::vector<Plane> round_an_axis() {
  return planes_of(
      conforming_normals({.pivot = Vector3d::Zero(), .radius = 1, .axis = Vector3d::UnitZ()}, kClosest, true, false));
}

std::vector<Plane> in_a_ball() {
  return planes_of(conforming_normals(
      {.pivot = Vector3d::Zero(), .radius = 1, .axis = Vector3d::UnitZ(), .is_in_ball = true}, kClosest, true, false));
}

std::vector<Plane> along_an_arc() {
  std::vector<Plane> planes;
  for (const double turn : kTurnsAlong)
    for (const double sense : {-1.0, 1.0})
      planes.push_back(
          {std::cos(turn) * kClosest + sense * std::sin(turn) * kBeside, std::pow(turn / kTurnAlongOfOne, 2)});
  return planes;
}

Vector3d force_at(std::span<const Plane> planes, const Vector3d& p) {
  Vector3d force = Vector3d::Zero();
  for (const Plane& plane : planes) force += plane.stiffness * std::max(0.0, plane.normal.dot(p) - 1) * plane.normal;
  return force;
}

/// The least part of the angle by which a place goes round that the force turns by, of all loads that press planes up
/// to an angle from `narrowest` to `widest` [rad].
double least_part_of_turn(std::span<const Plane> planes, double narrowest, double widest) {
  constexpr int kLoads = 400;
  double least = 1e9;
  for (int i = 0; i < kLoads; ++i) {
    const double pressed = narrowest * std::pow(widest / narrowest, static_cast<double>(i) / kLoads);  // rad
    const double r = 1 / std::cos(pressed);
    const double turn = 1e-5 * pressed;
    const Vector3d force = force_at(planes, r * (std::cos(turn) * kClosest + std::sin(turn) * kBeside));
    least = std::min(least, force.dot(kBeside) / force.dot(kClosest) / turn);
  }
  return least;
}

std::vector<Plane> as_stiff(std::vector<Plane> planes) {
  for (Plane& plane : planes) plane.stiffness = 1;
  return planes;
}

TEST(ConformingNormals, PressFromAllRoundWithoutADirection) {
  const std::vector<Plane> planes = round_an_axis();
  Vector3d sum = Vector3d::Zero();
  Matrix3d squares = Matrix3d::Zero();
  double all = 0;
  for (const Plane& plane : planes) {
    EXPECT_GT(plane.stiffness, 0);
    all += plane.stiffness;
    sum += plane.stiffness * plane.normal;
    squares += plane.stiffness * plane.normal * plane.normal.transpose();
  }
  EXPECT_LE(sum.norm(), 1e-5 * all);
  EXPECT_NEAR(squares(0, 0), squares(1, 1), 1e-5 * all);
  EXPECT_NEAR(squares(0, 1), 0, 1e-9 * all);
}

// Below a half what is held goes to and fro with growing force, until other planes act. Round an axis and in a ball few
// loads are below.
TEST(ConformingNormals, TurnAForceWithThePlace) {
  EXPECT_GE(least_part_of_turn(along_an_arc(), 0.004, 0.06), 0.5);
  EXPECT_GE(least_part_of_turn(round_an_axis(), 0.004, 0.2), 0.4);
  EXPECT_GE(least_part_of_turn(in_a_ball(), 0.02, 0.5), 0.2);
}

TEST(ConformingNormals, WouldNotDoSoIfTheyWereAsStiffAsTheClosest) {
  EXPECT_LE(least_part_of_turn(as_stiff(along_an_arc()), 0.004, 0.06), 0.2);
  EXPECT_LE(least_part_of_turn(as_stiff(round_an_axis()), 0.004, 0.2), 0.2);
  EXPECT_LE(least_part_of_turn(as_stiff(in_a_ball()), 0.02, 0.5), 0.1);
}

}  // namespace
}  // namespace verisim::exact::test::conforming_normals_test
