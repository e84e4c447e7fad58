// Several constraints at one contact: what all of them leave free is restored, nothing else.
#include "engine/constraint/reduction.hpp"

#include <gtest/gtest.h>

#include "tests/support/random_inputs.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::reduction_test {
namespace {

using test::tolerance;

ActiveConstraint flat(const Vector3d& normal, double alpha, bool unilateral = false) {
  ActiveConstraint c;
  c.kind = ConstraintKind::planar;
  c.direction = normal;
  c.alpha = alpha;
  c.unilateral = unilateral;
  return c;
}

Vector3d restore_both(const ActiveConstraint& a, const ActiveConstraint& b, const Vector3d& f) {
  const std::array<const ActiveConstraint*, 2> holding = {&a, &b};
  const std::array<double, 2> alpha = {a.alpha, b.alpha};
  return restore_common(holding, alpha, Vector3d::Zero(), f);
}

const Vector3d kF(1, 2, 3);

// A box's edge in the corner of two walls: only the slide along the edge is free.
TEST(CommonFreedom, OfTwoWallsIsTheirEdge) {
  const auto x = flat(Vector3d::UnitX(), 1);
  const auto y = flat(Vector3d::UnitY(), 1);
  EXPECT_LE((restore_both(x, y, kF) - Vector3d(1, 2, 0)).norm(), tolerance(1e-15));
}

// A plate thinner than a voxel: two faces that push opposite ways stand in one voxel. Each push is kept, in either
// order.
TEST(CommonFreedom, OfAThinPlateKeepsThePushOfEitherFace) {
  const auto top = flat(-Vector3d::UnitZ(), 1, true);
  const auto bottom = flat(Vector3d::UnitZ(), 1, true);
  for (const double z : {3.0, -3.0}) {
    const Vector3d f(1, 2, z);
    EXPECT_LE((restore_both(top, bottom, f) - Vector3d(0, 0, z)).norm(), tolerance(1e-15));
    EXPECT_LE((restore_both(bottom, top, f) - Vector3d(0, 0, z)).norm(), tolerance(1e-15));
  }
  EXPECT_LE(restore_both(top, top, -kF).norm(), tolerance(1e-15)) << "one face pushes one way";
}

TEST(CommonFreedom, OfThreeWallsIsNothing) {
  const auto x = flat(Vector3d::UnitX(), 1);
  const auto y = flat(Vector3d::UnitY(), 1);
  const auto z = flat(Vector3d::UnitZ(), 1);
  const std::array<const ActiveConstraint*, 3> holding = {&x, &y, &z};
  const std::array<double, 3> alpha = {1, 1, 1};
  EXPECT_LE((restore_common(holding, alpha, Vector3d::Zero(), kF) - kF).norm(), tolerance(1e-15));
}

// The expectation over subsets, by hand: both 0.3, only x 0.2, only y 0.3, neither 0.2 (0.5 and 0.6 independent).
// f' = 0.3 (1,2,0) + 0.2 (1,0,0) + 0.3 (0,2,0) + 0.2 (1,2,3) = (0.7, 1.6, 0.6).
TEST(CommonFreedom, GivesTheWorkedNumber) {
  const auto x = flat(Vector3d::UnitX(), 0.5);
  const auto y = flat(Vector3d::UnitY(), 0.6);
  EXPECT_LE((restore_both(x, y, kF) - Vector3d(0.7, 1.6, 0.6)).norm(), tolerance(1e-15));
}

TEST(CommonFreedom, OfOneConstraintIsEquation88) {
  for (const std::uint64_t seed : test::seeds(200)) {
    SCOPED_TRACE(seed);
    test::Inputs in(seed);
    const Vector3d f = in.vector(10);
    const auto c = flat(in.vector(1).normalized(), in.between(0, 1), seed % 2 == 0);
    const ActiveConstraint* holding = &c;
    const Vector3d common = restore_common({&holding, 1}, {&c.alpha, 1}, Vector3d::Zero(), f);
    EXPECT_LE((common - restore(c, Vector3d::Zero(), f)).norm(), tolerance(1e-14));
  }
}

TEST(CommonFreedom, IsThatOfTheOtherWhenOneFades) {
  for (const std::uint64_t seed : test::seeds(100)) {
    SCOPED_TRACE(seed);
    test::Inputs in(seed);
    const Vector3d f = in.vector(10);
    const auto c = flat(in.vector(1).normalized(), in.between(0, 1));
    const auto faded = flat(in.vector(1).normalized(), 0);
    EXPECT_LE((restore_both(c, faded, f) - restore(c, Vector3d::Zero(), f)).norm(), tolerance(1e-14));
    EXPECT_LE((restore_both(faded, c, f) - restore(c, Vector3d::Zero(), f)).norm(), tolerance(1e-14));
  }
}

TEST(CommonFreedom, NeverLengthensAForce) {
  for (const std::uint64_t seed : test::seeds(500)) {
    SCOPED_TRACE(seed);
    test::Inputs in(seed);
    const Vector3d f = in.vector(10);
    std::array<ActiveConstraint, 3> all;
    for (auto& c : all) c = flat(in.vector(1).normalized(), in.between(0, 1), in.between(0, 1) < 0.5);
    const std::array<const ActiveConstraint*, 3> holding = {&all[0], &all[1], &all[2]};
    const std::array<double, 3> alpha = {all[0].alpha, all[1].alpha, all[2].alpha};
    EXPECT_LE(restore_common(holding, alpha, Vector3d::Zero(), f).norm(), f.norm() * (1 + tolerance(1e-14)));
  }
}

// Two normals that turn into one, and a force that turns from push to pull: no jump on the way.
TEST(CommonFreedom, IsContinuousInNormalsAndForces) {
  Vector3d before = Vector3d::Zero();
  for (int i = -20000; i <= 20000; ++i) {
    const double t = 1e-5 * i;
    const auto x = flat(Vector3d::UnitX(), 0.9, true);
    const auto turned = flat(Vector3d(1, t, 0).normalized(), 0.8, true);
    const Vector3d f(0.3 + t, -1, 2);
    const Vector3d now = restore_both(x, turned, f);
    // The weight of the second normal rises from 1 to 10 degrees: at most 2.25 N / 0.03 x d(sin^2) = 2e-4 a step.
    const double step = i == -20000 ? 0 : (now - before).norm();
    ASSERT_LE(step, tolerance(3e-4)) << t;
    before = now;
  }
}

}  // namespace
}  // namespace verisim::reduction_test
