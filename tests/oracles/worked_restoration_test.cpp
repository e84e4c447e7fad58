// ORACLES section 2: degree-of-freedom restoration, eq. 8.3 to 8.9 of the dissertation.
#include "engine/constraint/restoration.hpp"

#include <gtest/gtest.h>

#include "tests/support/tolerance.hpp"

namespace verisim::worked_restoration_test {
namespace {

using test::tolerance;

const Vector3d kZ = Vector3d::UnitZ();

/// The dissertation's two, by name. Axis through `c` along the unit vector `v`.
Vector3d restore_cylindrical(const Vector3d& c, const Vector3d& v, const Vector3d& x, const Vector3d& f, double alpha) {
  ActiveConstraint axis;
  axis.kind = ConstraintKind::cylindrical;
  axis.field = NormalField::about_line;
  axis.alpha = alpha;
  axis.point = c;
  axis.direction = v;
  return restore(axis, x, f);
}

/// `n`: unit normal, from the body that feels f towards the other.
Vector3d restore_planar(const Vector3d& n, const Vector3d& f, double alpha) {
  return restore_along(n, f, alpha, /*unilateral=*/true);
}

// Eq. 8.8. Every inexact intermediate is below 4: one rounding is at most 2^-52, fewer than ten add.
TEST(RestoreCylindrical, GivesTheWorkedNumber) {
  const Vector3d f = restore_cylindrical(Vector3d::Zero(), kZ, {3, 4, 5}, {1, 2, 3}, 0.5);
  EXPECT_LE((f - Vector3d(1.16, 1.88, 1.5)).norm(), tolerance(10 * 0x1p-52));
}

// Eq. 8.9: exact in binary.
TEST(RestorePlanar, GivesTheWorkedNumbers) {
  EXPECT_EQ(restore_planar(kZ, {1, 2, 3}, 0.5), Vector3d(0.5, 1, 1.5));
  EXPECT_EQ(restore_planar(kZ, {1, 2, -3}, 0.5), Vector3d(0.5, 1, -3));
}

// Eq. 8.5 has no normal there.
TEST(RestoreCylindrical, LeavesAForceOnTheAxisAsItCame) {
  const Vector3d f(1, 2, 3);
  EXPECT_EQ(restore_cylindrical({1, 1, 1}, kZ, {1, 1, 7}, f, 0.5), f);
}

// The same through the engine's own path: recognized, brought into a pose, restored.
TEST(RestoreCylindrical, GivesTheWorkedNumberForARecognizedPin) {
  Constraint c;
  c.kind = ConstraintKind::cylindrical;
  c.pairing = Pairing::axis_axis;
  c.field = NormalField::about_line;
  c.normal_source = Side::a;
  c.pin = Side::b;
  c.unilateral = false;
  c.clearance = 0.005;
  c.a = {Vector3d::Zero(), kZ, 0.075, 0.1, 0};
  c.b = {Vector3d::Zero(), kZ, 0.070, 0.2, 0};
  const Vector3d f = restore(activate(c, {}, 0.5), {3, 4, 5}, {1, 2, 3});
  EXPECT_LE((f - Vector3d(1.16, 1.88, 1.5)).norm(), tolerance(10 * 0x1p-52));
}

}  // namespace
}  // namespace verisim::worked_restoration_test
