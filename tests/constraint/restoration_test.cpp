#include "engine/constraint/restoration.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "engine/base/pinned_math.hpp"
#include "tests/support/random_inputs.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::restoration_test {
namespace {

using test::Inputs;
using test::seeds;
using test::tolerance;

const Vector3d kZ = Vector3d::UnitZ();

/// One of each field of normals, fully aligned, about the origin and z.
std::vector<ActiveConstraint> all_fields(double alpha) {
  std::vector<ActiveConstraint> all;
  for (const NormalField field : {NormalField::constant, NormalField::about_line, NormalField::about_point,
                                  NormalField::about_cone, NormalField::about_ring}) {
    ActiveConstraint c;
    c.kind = ConstraintKind::other;
    c.field = field;
    c.alpha = alpha;
    c.direction = kZ;
    c.along = field == NormalField::about_ring ? 0.5 : -0.6;
    c.across = 0.8;
    all.push_back(c);
    c.unilateral = true;
    all.push_back(c);
  }
  return all;
}

TEST(Restore, IsDefinedWhereNoNormalExists) {
  const Vector3d f(1, -2, 3);
  for (const ActiveConstraint& c : all_fields(1)) {
    if (c.field == NormalField::constant) continue;
    EXPECT_EQ(restore(c, Vector3d::Zero(), f), f);
  }
  for (const ActiveConstraint& c : all_fields(1)) {  // the core circle itself
    if (c.field != NormalField::about_ring) continue;
    EXPECT_EQ(restore(c, {0.5, 0, 0}, f), f);
  }
}

// A projection and a shrinking: neither lengthens. 2^-50: a few roundings.
TEST(Restore, NeverMakesAForceLonger) {
  for (const std::uint64_t seed : seeds(500)) {
    SCOPED_TRACE(seed);
    Inputs in(seed);
    const Vector3d x = in.vector(1);
    const Vector3d f = in.vector(10);
    for (const ActiveConstraint& c : all_fields(in.between(0, 1))) {
      EXPECT_LE(restore(c, x, f).norm(), f.norm() * (1 + tolerance(0x1p-50)));
    }
  }
}

TEST(Restore, ChangesNothingWhenNothingIsAligned) {
  const Vector3d f(1, -2, 3);
  for (const ActiveConstraint& c : all_fields(0)) {
    EXPECT_LE((restore(c, {0.3, 0.4, 0.5}, f) - f).norm(), tolerance(1e-15));
  }
}

// The power of f' along each motion that the constraint leaves free, at full alignment (residual: roundings of 10 N).
TEST(Restore, LeavesNoPowerInTheFreeMotions) {
  for (const std::uint64_t seed : seeds(200)) {
    SCOPED_TRACE(seed);
    Inputs in(seed);
    const Vector3d x = in.vector(1);
    const Vector3d f = in.vector(10);
    const std::vector<ActiveConstraint> all = all_fields(1);
    const double slack = tolerance(1e-13);
    const Vector3d planar = restore(all[0], x, f);
    EXPECT_LE(planar.head<2>().norm(), slack);
    const Vector3d cylindrical = restore(all[2], x, f);
    EXPECT_LE(std::abs(cylindrical.z()), slack);                     // slide
    EXPECT_LE(std::abs(x.cross(cylindrical).z()), slack);            // spin
    EXPECT_LE(x.cross(restore(all[4], x, f)).norm(), slack);         // spherical: all turns
    EXPECT_LE(std::abs(x.cross(restore(all[6], x, f)).z()), slack);  // conical: spin
    EXPECT_LE(std::abs(x.cross(restore(all[8], x, f)).z()), slack);  // ring: spin
  }
}

// Halves that mate: a taper of half angle h, the inner one being B. Pushed in (-z), the seat's normal force stays; what
// would hold the taper in its seat does not.
TEST(RestoreConical, KeepsTheSeatAndFreesTheWayOut) {
  const double h = 0.3;
  Constraint c;
  c.kind = ConstraintKind::conical;
  c.pairing = Pairing::axis_axis;
  c.field = NormalField::about_cone;
  c.normal_source = Side::a;
  c.pin = Side::b;
  c.unilateral = true;
  c.clearance = 0;
  c.a = c.b = {Vector3d::Zero(), kZ, 0.05, 0.02, pinned::tan(h)};
  const ActiveConstraint seat = activate(c, Pose(), 1);
  const Vector3d outward(pinned::cos(h), 0, -pinned::sin(h));  // of the inner cone at (x, 0, 0)
  const Vector3d x(0.05, 0, 0);
  EXPECT_LE((restore(seat, x, -3 * outward) + 3 * outward).norm(), tolerance(1e-15));
  EXPECT_LE(restore(seat, x, 3 * outward).norm(), tolerance(1e-15));
  EXPECT_LE(restore(seat, x, Vector3d(0, 2, 0)).norm(), tolerance(1e-15));
}

}  // namespace
}  // namespace verisim::restoration_test
