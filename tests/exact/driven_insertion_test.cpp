#include "tests/exact/driven_insertion.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/length.hpp"

namespace verisim::exact::test::driven_insertion_test {
namespace {

struct Case {
  double clearance;
  double peak;  ///< N
};

/// Peak forces: MuJoCo's with stiff contacts and those of ../shared/reference/exact, which agree.
class DrivenInsertion : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Clearances, DrivenInsertion,
                         ::testing::ValuesIn(verisim::test::some_of(
                             {Case{1e-3, 9.3}, Case{1e-4, 13.3}, Case{2e-5, 13.7}, Case{1e-5, 13.7}}, 4)));

TEST_P(DrivenInsertion, ReachesTheEndWithTheKnownForce) {
  const Outcome o = run({.clearance = GetParam().clearance});
  EXPECT_NEAR(o.bottom, -0.12, 2e-5);
  EXPECT_NEAR(o.force_max, GetParam().peak, 0.06);  // given to a tenth of a newton
  EXPECT_LE(o.jump_max, 10);  // N: a fifth of what would stop 1 kg at the hand's speed within a frame
}

TEST(DrivenInsertionAtManyClearances, HardlyOverlaps) {
  for (const double clearance : verisim::test::some_of({1e-5, 1.4e-5, 2e-5, 2.8e-5, 4e-5, 5.6e-5, 8e-5}, 7)) {
    SCOPED_TRACE(clearance);
    EXPECT_LE(run({.clearance = clearance}).overlap_max, 0.01 * clearance);
  }
}

// While the hand slowly leans, two rims hold the pin between them by up to 150 N, and the places where they do go round
// with it. Where most of a rim's rows lay at its closest place, the force went to and fro by 2 to 8 N every other step.
TEST(DrivenInsertionAtManyClearances, PressesASlowlyLeaningPinEvenly) {
  for (const double clearance : verisim::test::some_of({1e-5, 1.6e-5, 2e-5, 3e-5, 4e-5, 5e-5}, 6)) {
    SCOPED_TRACE(clearance);
    Vector3d before = Vector3d::Zero();
    double most = 0;  // N, from step to step; the hand's own is 0.026
    (void)run({.clearance = clearance}, [&](const HeldPin& pin, int frame) {
      if (frame > 425 && frame < 495) most = std::max(most, (pin.contact_force - before).norm());
      before = pin.contact_force;
    });
    EXPECT_LE(most, 0.05);
  }
}

// The Virtuose's strongest push, through a coupling ten times as stiff.
TEST_P(DrivenInsertion, HardlyOverlapsUnder35Newtons) {
  const Outcome o = run({.clearance = GetParam().clearance, .force_max = 35, .push = 10});
  EXPECT_NEAR(o.bottom, -0.12, 2e-5);
  EXPECT_GE(o.force_max, 35);
  EXPECT_LE(o.overlap_max, 0.05 * GetParam().clearance);
}

TEST_P(DrivenInsertion, HardlyDependsOnTheSpacingOfSamples) {
  const double clearance = GetParam().clearance;
  const Outcome wide = run({.clearance = clearance});
  const Outcome close = run({.clearance = clearance, .spacing = 0.00225});
  EXPECT_LE((close.pose.position - wide.pose.position).norm(), 0.02 * clearance);
  const double turned = vector_from_rotation(close.pose.rotation * wide.pose.rotation.conjugate()).norm();
  EXPECT_LE(turned * kPinLength / 2, 0.02 * clearance);
  EXPECT_LE((close.coupling.force - wide.coupling.force).norm(), 0.002 * wide.coupling.force.norm());
  EXPECT_LE((close.coupling.torque - wide.coupling.torque).norm(), 0.002 * wide.coupling.torque.norm());
}

TEST_P(DrivenInsertion, DoesNotDependOnTheTessellation) {
  const double clearance = GetParam().clearance;
  const Outcome coarse = run({.clearance = clearance});
  const Outcome fine = run({.clearance = clearance, .load = {.deflection = 2.5e-5, .angular_deflection = 0.025}});
  EXPECT_EQ(coarse.pose.position, fine.pose.position);
  EXPECT_EQ(coarse.pose.rotation.coeffs(), fine.pose.rotation.coeffs());
  EXPECT_EQ(coarse.coupling.force, fine.coupling.force);
  EXPECT_EQ(coarse.coupling.torque, fine.coupling.torque);
}

}  // namespace
}  // namespace verisim::exact::test::driven_insertion_test
