// The comparator: target poses that satisfy their constraints, the nearest ones, and the mixture.
#include "engine/constraint/blend.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/constraint/recognition.hpp"
#include "tests/constraint/shapes.hpp"
#include "tests/contact/allocations.hpp"
#include "tests/support/random_inputs.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::blend_test {
namespace {

using test::cylinder;
using test::kX;
using test::kZ;
using test::plane;
using test::sphere;
using test::tolerance;

const Vector3d kCenter(0, 0, 0.05);
const BlendParameters kParameters = {.steps_max = 8};

ConstraintForce solve(const std::vector<Constraint>& constraints, const Pose& X, double alpha = 1) {
  std::vector<Engaged> engaged;
  engaged.reserve(constraints.size());
  for (const Constraint& c : constraints) engaged.push_back({&c, alpha, 1});
  return constraint_force(engaged, X, kCenter, kParameters);
}

const Constraint kPeg = recognize(cylinder(0.075, true), cylinder(0.070, false));

TEST(ConstraintForce, OfNothingIsZero) {
  const ConstraintForce none = solve({}, {{1, 2, 3}, Quaterniond::Identity()});
  EXPECT_EQ(none.alpha, 0);
  EXPECT_EQ(none.on_b.force, Vector3d::Zero());
  EXPECT_EQ(none.on_b.torque, Vector3d::Zero());
}

// A pin 2 mm beside the axis and turned about it: pulled straight back, not turned, not moved along.
TEST(ConstraintForce, PullsAPinOntoTheAxisAndNotAlongIt) {
  const Pose X = {{0.002, 0, 0.03}, rotation_from_vector(0.7 * kZ)};
  const ConstraintForce c = solve({kPeg}, X);
  EXPECT_LE((c.X_AB_target.position - Vector3d(0, 0, 0.03)).norm(), tolerance(1e-10));
  EXPECT_LE((c.on_b.force - 300 * Vector3d(-0.002, 0, 0)).norm(), tolerance(1e-7));
  EXPECT_LE(c.on_b.torque.norm(), tolerance(1e-9));
  EXPECT_EQ(c.alpha, 1);
}

// Worked: tilted by 0.1 rad about x through its centre: the torque is 0.1 N m/rad x 0.1 rad the other way.
TEST(ConstraintForce, TurnsAPinUpright) {
  const Quaterniond tilt = rotation_from_vector(0.1 * kX);
  const Pose X = {kCenter - tilt * kCenter, tilt};  // the centre stays where it is
  const ConstraintForce c = solve({kPeg}, X);
  EXPECT_LE((c.on_b.torque - Vector3d(-0.01, 0, 0)).norm(), tolerance(1e-8));
  EXPECT_LE((c.X_AB_target.rotation * kZ - kZ).norm(), tolerance(1e-8));
}

// Every kind, from random starts: the target satisfies the constraint, measured by the alignment's own distances.
TEST(ConstraintForce, FindsPosesThatSatisfyTheConstraints) {
  const std::vector<Constraint> kinds = {kPeg,
                                         mirrored(kPeg),
                                         recognize(plane(kZ), plane(-kZ)),
                                         recognize(sphere(0.03, true), sphere(0.029, false)),
                                         recognize(cylinder(0.03, true), sphere(0.029, false)),
                                         recognize(sphere(0.029, false), cylinder(0.03, true)),
                                         recognize(plane(kZ), sphere(0.02, false)),
                                         recognize(sphere(0.02, false), plane(kZ)),
                                         recognize(plane(kZ), cylinder(0.02, false)),
                                         recognize(cylinder(0.02, false), plane(kZ)),
                                         recognize(test::torus(0.1, 0.01, true), test::torus(0.1, 0.0095, false)),
                                         recognize(plane(kZ), test::line(kX))};
  for (const std::uint64_t seed : test::seeds(50)) {
    test::Inputs in(seed);
    const Pose X = {in.vector(0.02), rotation_from_vector(in.vector(0.3))};
    for (std::size_t k = 0; k < kinds.size(); ++k) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", kind " << k);
      ASSERT_NE(kinds[k].kind, ConstraintKind::none);
      const Misalignment m = misalignment(kinds[k], solve({kinds[k]}, X).X_AB_target);
      EXPECT_LE(m.distance, tolerance(1e-7));
      EXPECT_LE(m.sine, tolerance(1e-6));
    }
  }
}

// Figure 8.2: two pins 10 mm farther apart than their holes. The compromise: 5 mm of miss at each, no pull to any side.
TEST(ConstraintForce, OfContradictingConstraintsIsTheirCompromise) {
  const auto pair = [](double hole, double pin) {
    return recognize(cylinder(0.012, true, 0.1, {hole, 0, 0}), cylinder(0.0115, false, 0.1, {pin, 0, 0}));
  };
  const ConstraintForce c = solve({pair(-0.05, -0.055), pair(0.05, 0.055)}, Pose());
  EXPECT_LE(c.X_AB_target.position.norm(), tolerance(1e-9));
  EXPECT_LE(c.on_b.force.norm(), tolerance(1e-6));
  EXPECT_NEAR(c.residual, std::sqrt(2 * 0.005 * 0.005), tolerance(1e-6));
}

TEST(Blended, MixesByAlignment) {
  const Wrench collision = {{1, 0, 0}, {0, 2, 0}};
  const Wrench spring = {{0, 4, 0}, {0, 0, 8}};
  const Wrench mixed = blended(collision, spring, 0.25);
  EXPECT_EQ(mixed.force, Vector3d(0.75, 1, 0));
  EXPECT_EQ(mixed.torque, Vector3d(0, 1.5, 2));
}

TEST(ConstraintForce, AllocatesNothing) {
  const std::array<Engaged, 1> one = {Engaged{&kPeg, 1, 1}};
  const std::uint64_t before = allocations;
  (void)constraint_force(one, {{0.002, 0, 0.03}, Quaterniond::Identity()}, kCenter, kParameters);
  EXPECT_EQ(allocations, before);
}

}  // namespace
}  // namespace verisim::blend_test
