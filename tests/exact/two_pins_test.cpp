// A light plate with two pins, leaning on the rims of two holes: 60 rows, many of them nearly the same, are near.
#include <gtest/gtest.h>

#include "tests/exact/held_pin.hpp"
#include "tests/exact/scenes.hpp"
#include "tests/length.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::exact::test::two_pins_test {
namespace {

using Kind = Solid::Kind;
using verisim::test::tolerance;

const Vector3d kCenter(0, 0, -0.00968);  // m, of the plate's mass
constexpr double kApart = 0.12, kHole = 0.025, kPin = 0.0248, kLength = 0.09, kHeight = 0.06;

Solid at(const Solid& solid, const Vector3d& p) {
  return placed(solid, {p, Quaterniond::Identity()});
}
Solid block() {
  const Solid hole = make(Kind::cylinder, {kHole, kHeight});
  const Solid one = combine(Kind::difference, make(Kind::box, {0.26, 0.12, kHeight}), at(hole, {-kApart / 2, 0, 0}));
  return combine(Kind::difference, one, at(hole, {kApart / 2, 0, 0}));
}
Solid pin_under_plate(const Solid& plate, double radius, double x) {
  return combine(Kind::sum, plate, at(make(Kind::cylinder, {radius, kLength}), {x, 0, -kLength / 2}));
}
Solid one_pin() {
  return pin_under_plate(at(make(Kind::box, {0.26, 0.12, 0.02}), {0, 0, 0.01}), kPin, kApart / 2);
}
Solid two_pins(double radius = kPin) {
  const Solid plate = at(make(Kind::box, {0.26, 0.12, 0.02}), {0, 0, 0.01});
  return pin_under_plate(pin_under_plate(plate, radius, -kApart / 2), radius, kApart / 2);
}

/// The plate, by its center of mass.
HeldBody held_plate(const Solid& held) {
  HeldBody plate(body_of(block(), 0.003), body_of(placed(held, {-kCenter, Quaterniond::Identity()}), 0.003), 0.0246,
                 {4.35e-5, 1.3e-4, 1.3e-4});
  plate.stiffness = 300;
  plate.damping = 2 * std::sqrt(300 * 0.0246);
  plate.angular_stiffness = 0.5;
  return plate;
}

// Both pins stand a millimetre beside their holes, where their ends coincide with the block's top on two half-moons. A
// shaking hand presses with 12 N near the tips of these half-moons. With a single row per group, at the place that is
// closest by a rounding error, the plate tips to and fro, 5 um deep and at half a radian per second.
TEST(PlateWithTwoPins, LiesStillBesideItsHoles) {
  for (double turn = 3.9; turn < 4.65; turn += verisim::test::by_length(0.4, 0.1, 0.1)) {
    SCOPED_TRACE(turn);
    HeldBody plate = held_plate(two_pins(kHole - 1e-5));
    const Vector3d beside = 0.001 * Vector3d(std::cos(turn), std::sin(turn), 0);
    const double lies = 0.5 * kHeight + kLength + kCenter.z();
    plate.X_WB.position = beside + Vector3d(0, 0, lies);
    double deepest = 0;
    double fastest = 0;
    for (int i = 0; i < 300; ++i) {
      const double t = 0.001 * i;
      Hand hand{beside + Vector3d(0, 0, lies - 0.04), Quaterniond::Identity(), Vector3d::Zero()};
      hand.position += 2e-4 * Vector3d(std::sin(55 * t), std::sin(47 * t), 0);
      hand.rotation = rotation_from_vector(0.003 * Vector3d(std::sin(40 * t), std::sin(60 * t), std::sin(50 * t)));
      plate.step(hand);
      deepest = std::max(deepest, plate.link.depth_max());
      fastest = std::max(fastest, plate.omega.head<2>().norm());
    }
    EXPECT_LE(deepest, 1e-8);
    EXPECT_LE(fastest, 1e-3);
    EXPECT_NEAR(plate.contact_force.z(), 12, 0.1);
  }
}

// A plate leans on the block by its edge and by its one pin, whose rim crosses the hole's rim at two places, 44 mm
// apart. These wander along both rims. Wherever they are, also at the ends of segments, the rows there are as stiff as
// those of a group.
TEST(LeaningPlate, IsHeldAllAlongTheRims) {
  Pair pair(block(), one_pin(), 0.003);
  for (int i = -100; i < 100; ++i) {
    SCOPED_TRACE(i);
    const Vector3d p = Vector3d(-0.011847112678, 0.000378084938, 0.088535614879) + i * Vector3d(1.7e-7, 4.3e-7, 2e-8);
    const Pose X{p, Quaterniond(0.97285079943, -0.00060870597, -0.23141824358, -0.00255891897).normalized()};
    const Twist free{{0.0985, 0.0041, -0.5138}, {-0.0096, 1.4988, -0.0431}};
    const Twist before{{0.0017, 0.0035, 0.0003}, {0, -0.0022, -0.0595}};
    pair.link.find({}, {X, X * kCenter, free, before}, 0.001, 4e-4);
    std::array<double, 2> held{};  // N/m
    for (const ContactRow& row : pair.link.rows().rows()) {
      const bool is_at_crossing =
          row.point.x() > 0.07 && row.point.x() < 0.074 && std::abs(row.normal.z() - 0.89) < 0.01;
      if (is_at_crossing && row.normal.head<2>().norm() > 0.1) held[row.point.y() > 0 ? 1 : 0] += row.stiffness;
    }
    EXPECT_GE(held[0], 1e9);
    EXPECT_GE(held[1], 1e9);
  }
}

// The same condition as in convex_step_test, where it is hard: directions that hardly have inertia (a light plate that
// rolls on four places of its pins' rims) and rows that begin to act one shortly after the other.
TEST(PlateWithTwoPins, IsMovedAsItsMomentumSays) {
  Pair pair(block(), two_pins(), 0.003);
  Matrix6d M = Matrix6d::Zero();
  M.diagonal() << 0.0246, 0.0246, 0.0246, 4.35e-5, 1.3e-4, 1.3e-4;
  ConvexStep step(4096);
  int acting = 0;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    SCOPED_TRACE(seed);
    Draw draw(seed);
    const double little = seed < 1000 ? 1e-6 : 1e-4;
    const Vector3d p = Vector3d(0, 0.001126616, 0.119694507) + draw.in_box(Vector3d::Constant(little));
    const Pose X{p, rotation_from_vector({-0.015394 + draw.between(-0.1, 0.1) * little, 0, 0})};
    Vector6d u0;
    u0 << 0, 0.0715, -0.2202, -0.7412, 0, 0;
    for (int i = 0; i < 6; ++i) u0[i] += 100 * draw.between(-1, 1) * little;
    const Vector3d p_WC = X * kCenter;
    pair.link.find({}, {X, p_WC, {u0.head<3>(), u0.tail<3>()}}, 0.001, 4e-4);
    step.clear();
    const int body = step.add_body(p_WC, M, u0, u0);
    step.add_rows(pair.link.rows().rows(), kFixed, body);
    EXPECT_LE(step.solve(0.001), 40);
    const Wrench w = step.wrench(body);
    Vector6d impulse;
    impulse << w.force, w.torque;
    impulse *= 0.001;
    double scale = 0;
    for (std::size_t i = 0; i < step.row_count(); ++i) {
      scale += 0.001 * step.force(i);
      acting += step.force(i) > 0 ? 1 : 0;
    }
    ASSERT_LE((impulse - M * (step.velocity(body) - u0)).norm(), tolerance(1e-5 * scale + 1e-12));
  }
  EXPECT_GT(acting, 4000);
}

}  // namespace
}  // namespace verisim::exact::test::two_pins_test
