// Which pairs are recognized, just inside and just outside each tolerance, in both orders.
#include "engine/constraint/recognition.hpp"
#include "engine/constraint/restoration.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/constraint/recognizers.hpp"
#include "tests/constraint/shapes.hpp"
#include "tests/contact/allocations.hpp"
#include "tests/support/random_inputs.hpp"

namespace verisim::recognition_test {
namespace {

using test::circle;
using test::cone;
using test::cylinder;
using test::ellipse;
using test::kOrigin;
using test::kZ;
using test::line;
using test::plane;
using test::sphere;
using test::torus;

constexpr bool kHole = true, kPin = false;

bool same(const ConstraintSide& a, const ConstraintSide& b) {
  return a.point == b.point && a.direction == b.direction && a.radius == b.radius && a.half_length == b.half_length &&
         a.detail == b.detail;
}
bool same(const Constraint& a, const Constraint& b) {
  if (a.kind != b.kind) return false;
  if (a.kind == ConstraintKind::none) return true;
  return a.pairing == b.pairing && a.field == b.field && a.normal_source == b.normal_source && a.pin == b.pin &&
         a.unilateral == b.unilateral && a.clearance == b.clearance && same(a.a, b.a) && same(a.b, b.b);
}

/// The kind, after checking that the other order says the same with the sides swapped.
ConstraintKind kind(const Entity& a, const Entity& b) {
  const Constraint c = recognize(a, b);
  const Constraint swapped = recognize(b, a);
  EXPECT_EQ(c.kind, swapped.kind);
  // Two entities of one type without pin or hole: either may be called the first.
  EXPECT_TRUE(same(c, mirrored(swapped)));
  return c.kind;
}

TEST(Recognition, FindsAPinInItsHole) {
  const Constraint c = recognize(cylinder(0.075, kHole), cylinder(0.070, kPin));
  EXPECT_EQ(c.kind, ConstraintKind::cylindrical);
  EXPECT_EQ(c.pin, Side::b);
  EXPECT_EQ(c.normal_source, Side::a);
  EXPECT_NEAR(c.clearance, 0.005, 1e-15);
  EXPECT_EQ(c.a.radius, 0.075);
  EXPECT_EQ(c.b.radius, 0.070);
  EXPECT_EQ(kind(cylinder(0.075, kHole), cylinder(0.070, kPin)), ConstraintKind::cylindrical);
}

TEST(Recognition, FitsAPinOnlyIntoAHole) {
  EXPECT_EQ(kind(cylinder(0.075, kPin), cylinder(0.070, kPin)), ConstraintKind::none);
  EXPECT_EQ(kind(cylinder(0.075, kHole), cylinder(0.070, kHole)), ConstraintKind::none);
  EXPECT_EQ(kind(sphere(0.075, kPin), sphere(0.070, kPin)), ConstraintKind::none);
  EXPECT_EQ(kind(cone(0.05, 0.3, kPin), cone(0.05, 0.3, kPin)), ConstraintKind::none);
  EXPECT_EQ(kind(torus(0.05, 0.01, kHole), torus(0.05, 0.0099, kHole)), ConstraintKind::none);
}

// Tolerances::clearance_relative_max = 0.15 of the hole; interference_max = 1e-8 m.
TEST(Recognition, RefusesWhatIsTooLooseOrTooLarge) {
  const Entity hole = cylinder(0.1, kHole);
  EXPECT_EQ(kind(hole, cylinder(0.0851, kPin)), ConstraintKind::cylindrical);
  EXPECT_EQ(kind(hole, cylinder(0.0849, kPin)), ConstraintKind::none);
  EXPECT_EQ(kind(hole, cylinder(0.1, kPin)), ConstraintKind::cylindrical);
  EXPECT_EQ(kind(hole, cylinder(0.1 + 0.9e-8, kPin)), ConstraintKind::cylindrical);
  EXPECT_EQ(kind(hole, cylinder(0.1 + 1.1e-8, kPin)), ConstraintKind::none);  // a press fit
}

TEST(Recognition, FindsRimsAndWhatTheyRunAlong) {
  EXPECT_EQ(kind(circle(0.075, Role::hole), cylinder(0.070, kPin)), ConstraintKind::cylindrical);
  EXPECT_EQ(kind(circle(0.070, Role::pin), cylinder(0.075, kHole)), ConstraintKind::cylindrical);
  EXPECT_EQ(kind(circle(0.070, Role::unknown), cylinder(0.075, kHole)), ConstraintKind::cylindrical);
  EXPECT_EQ(kind(circle(0.070, Role::pin), cylinder(0.075, kPin)), ConstraintKind::none);
  EXPECT_EQ(kind(circle(0.080, Role::pin), cylinder(0.075, kHole)), ConstraintKind::none);
  EXPECT_EQ(kind(circle(0.075, Role::hole), circle(0.070, Role::pin)), ConstraintKind::cylindrical);
  EXPECT_EQ(kind(circle(0.075, Role::pin), circle(0.070, Role::pin)), ConstraintKind::none);
}

TEST(Recognition, LetsTheFaceGiveTheNormalsOfAnEdge) {
  EXPECT_EQ(recognize(circle(0.075, Role::hole), cylinder(0.070, kPin)).normal_source, Side::b);
  EXPECT_EQ(recognize(circle(0.070, Role::pin), cylinder(0.075, kHole)).normal_source, Side::b);
}

TEST(Recognition, FindsPlanesAndWhatLiesOnThem) {
  EXPECT_EQ(kind(plane(kZ), sphere(0.02, kPin)), ConstraintKind::other);
  EXPECT_EQ(kind(plane(kZ), sphere(0.02, kHole)), ConstraintKind::none);
  EXPECT_EQ(kind(plane(kZ), cylinder(0.02, kPin)), ConstraintKind::other);
  EXPECT_EQ(kind(plane(kZ), cylinder(0.02, kHole)), ConstraintKind::none);
  EXPECT_EQ(kind(plane(kZ), line(Vector3d::UnitX())), ConstraintKind::other);
  EXPECT_EQ(kind(plane(kZ), plane(-kZ)), ConstraintKind::planar);
}

// What lies on a plate feels the plate's normal, whichever of the two bodies has the voxmap; of equal planes A's.
TEST(Recognition, LetsTheLargerOfTwoPlanesGiveTheNormal) {
  const Entity large = plane(kZ, kOrigin, 0.1), small = plane(-kZ, kOrigin, 0.02);
  EXPECT_EQ(kind(large, small), ConstraintKind::planar);
  EXPECT_EQ(recognize(large, small).normal_source, Side::a);
  EXPECT_EQ(recognize(small, large).normal_source, Side::b);
  const Pose tilted{Vector3d::Zero(), Quaterniond(Eigen::AngleAxisd(0.1, Vector3d::UnitX()))};  // B in A
  EXPECT_EQ(activate(recognize(large, small), tilted, 1).direction, -kZ);
  EXPECT_EQ(activate(recognize(small, large), tilted, 1).direction, tilted.rotation * kZ);
  EXPECT_EQ(activate(recognize(large, plane(-kZ, kOrigin, 0.1)), tilted, 1).direction, -kZ);
}

// half_angle_difference_max = 0.00873 rad; flanks of 0.04 m at 0.3 rad span +-6.2 mm of radius.
TEST(Recognition, FindsAConeInACone) {
  const Entity socket = cone(0.05, 0.3, kHole);
  EXPECT_EQ(kind(socket, cone(0.05, 0.3, kPin)), ConstraintKind::conical);
  EXPECT_EQ(kind(socket, cone(0.05, 0.3 + 0.0087, kPin)), ConstraintKind::conical);
  EXPECT_EQ(kind(socket, cone(0.05, 0.3 + 0.0088, kPin)), ConstraintKind::none);
  EXPECT_EQ(kind(socket, cone(0.05 + 0.0123, 0.3, kPin)), ConstraintKind::conical);
  EXPECT_EQ(kind(socket, cone(0.05 + 0.0124, 0.3, kPin)), ConstraintKind::none);
  EXPECT_TRUE(recognize(socket, cone(0.05, 0.3, kPin)).unilateral);
}

// The cone's radii: 0.05 -+ 0.02 tan 0.3 = 0.0438 to 0.0562. A ball of r touches where the radius is r cos 0.3.
TEST(Recognition, FindsWhatSitsInACountersink) {
  const Entity sink = cone(0.05, 0.3, kHole);
  EXPECT_EQ(kind(sink, circle(0.0439, Role::pin)), ConstraintKind::conical);
  EXPECT_EQ(kind(sink, circle(0.0437, Role::pin)), ConstraintKind::none);
  EXPECT_EQ(kind(sink, circle(0.05, Role::hole)), ConstraintKind::none);
  EXPECT_EQ(kind(cone(0.05, 0.3, kPin), circle(0.05, Role::hole)), ConstraintKind::conical);
  EXPECT_EQ(kind(sink, sphere(0.05 / std::cos(0.3), kPin)), ConstraintKind::spherical);
  EXPECT_EQ(kind(sink, sphere(0.0439 / std::cos(0.3), kPin)), ConstraintKind::spherical);
  EXPECT_EQ(kind(sink, sphere(0.0437 / std::cos(0.3), kPin)), ConstraintKind::none);
  EXPECT_EQ(kind(sink, sphere(0.05, kHole)), ConstraintKind::none);
}

TEST(Recognition, FindsBallsInSocketsAndTubes) {
  EXPECT_EQ(kind(sphere(0.03, kHole), sphere(0.029, kPin)), ConstraintKind::spherical);
  EXPECT_EQ(kind(cylinder(0.03, kHole), sphere(0.029, kPin)), ConstraintKind::annular);
  EXPECT_EQ(kind(cylinder(0.03, kHole), sphere(0.031, kPin)), ConstraintKind::none);
  EXPECT_EQ(kind(cylinder(0.029, kPin), sphere(0.03, kHole)), ConstraintKind::none);
}

// core_relative_max = 0.02.
TEST(Recognition, FindsARingInItsGroove) {
  EXPECT_EQ(kind(torus(0.1, 0.010, kHole), torus(0.1, 0.0095, kPin)), ConstraintKind::other);
  EXPECT_EQ(kind(torus(0.1, 0.010, kHole), torus(0.0981, 0.0095, kPin)), ConstraintKind::other);
  EXPECT_EQ(kind(torus(0.1, 0.010, kHole), torus(0.0979, 0.0095, kPin)), ConstraintKind::none);
  EXPECT_EQ(kind(torus(0.1, 0.010, kHole), torus(0.1, 0.0105, kPin)), ConstraintKind::none);
}

// Bad input: zero radius, zero length, not a number. Such an entity has no equation and is recognized with nothing.
TEST(Recognition, TakesNothingThatHasNoSize) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Entity& bad : {cylinder(0, kPin), cylinder(-1, kPin), cylinder(nan, kPin), cylinder(0.07, kPin, 0),
                            cylinder(0.07, kPin, 0.1, {nan, 0, 0}), cylinder(0.07, kPin, 0.1, kOrigin, {0, 0, 0.5})}) {
    EXPECT_TRUE(std::holds_alternative<Bounded<OtherSurface>>(bad));
    EXPECT_EQ(kind(bad, cylinder(0.075, kHole)), ConstraintKind::none);
  }
  EXPECT_TRUE(std::holds_alternative<Bounded<OtherSurface>>(sphere(0, kPin)));
  EXPECT_TRUE(std::holds_alternative<Bounded<OtherSurface>>(cone(0.05, 0, kPin)));
  EXPECT_TRUE(std::holds_alternative<Bounded<OtherSurface>>(cone(0.05, 1.5708, kPin)));
  EXPECT_TRUE(std::holds_alternative<Bounded<OtherSurface>>(torus(0.05, 0, kPin)));
  EXPECT_TRUE(std::holds_alternative<Bounded<OtherSurface>>(plane(kZ, kOrigin, 0)));
  EXPECT_TRUE(std::holds_alternative<Bounded<OtherCurve>>(line(kZ, kOrigin, 0)));
  EXPECT_TRUE(std::holds_alternative<Bounded<OtherCurve>>(circle(0, Role::pin)));
}

/// Some of everything, sizes drawn so that fits and misfits both occur.
std::vector<Entity> mixed(std::uint64_t seed, int count) {
  test::Inputs in(seed);
  std::vector<Entity> all;
  for (int i = 0; i < count; ++i) {
    const bool hole = in.between(0, 1) < 0.5;
    const double r = in.between(0.05, 0.06);
    const Role role = hole ? Role::hole : Role::pin;
    const std::array<Entity, 10> one = {
        plane(kZ),           cylinder(r, hole),       cone(r, 0.3, hole), sphere(r, hole),
        torus(0.2, r, hole), Bounded<OtherSurface>(), line(kZ),           circle(r, role),
        ellipse(r, r / 2),   Bounded<OtherCurve>()};
    all.push_back(one[static_cast<std::size_t>(in.between(0, 9.999))]);
  }
  return all;
}

TEST(Recognition, AllocatesNothing) {
  const std::vector<Entity> a = mixed(1, 60);
  const std::vector<Entity> b = mixed(2, 60);
  const std::uint64_t before = allocations;
  int recognized = 0;
  for (const Entity& x : a) {
    for (const Entity& y : b) recognized += recognize(x, y).kind != ConstraintKind::none ? 1 : 0;
  }
  EXPECT_EQ(allocations, before);
  EXPECT_GT(recognized, 0);
}

}  // namespace
}  // namespace verisim::recognition_test
