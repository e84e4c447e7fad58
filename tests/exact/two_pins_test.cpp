// A light plate with two pins, leaning on the rims of two holes: 60 rows, many of them nearly the same, are near.
#include <gtest/gtest.h>

#include "engine/exact/convex_step.hpp"
#include "tests/exact/scenes.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::exact::test {
namespace {

using Kind = Solid::Kind;
using verisim::test::tolerance;

constexpr double kApart = 0.12, kHole = 0.025, kPin = 0.0248, kLength = 0.09, kHeight = 0.06;

Solid at(const Solid& solid, const Vector3d& p) {
  return placed(solid, {p, Quaterniond::Identity()});
}
Solid block() {
  const Solid hole = make(Kind::cylinder, {kHole, kHeight});
  const Solid one = combine(Kind::difference, make(Kind::box, {0.26, 0.12, kHeight}), at(hole, {-kApart / 2, 0, 0}));
  return combine(Kind::difference, one, at(hole, {kApart / 2, 0, 0}));
}
Solid plate() {
  const Solid pin = make(Kind::cylinder, {kPin, kLength});
  const Solid one = combine(Kind::sum, at(make(Kind::box, {0.26, 0.12, 0.02}), {0, 0, 0.01}),
                            at(pin, {-kApart / 2, 0, -kLength / 2}));
  return combine(Kind::sum, one, at(pin, {kApart / 2, 0, -kLength / 2}));
}

// The same condition as in convex_step_test, where it is hard: directions that hardly have inertia (a light plate that
// rolls on four places of its pins' rims) and rows that begin to act one shortly after the other.
TEST(PlateWithTwoPins, IsMovedAsItsMomentumSays) {
  Pair pair(block(), plate(), 0.003);
  Matrix6d M = Matrix6d::Zero();
  M.diagonal() << 0.0246, 0.0246, 0.0246, 4.35e-5, 1.3e-4, 1.3e-4;
  const Vector3d center(0, 0, -0.00968);
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
    const Vector3d p_WC = X * center;
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
}  // namespace verisim::exact::test
