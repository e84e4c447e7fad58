#include "engine/dynamics/coupling.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/dynamics/integrator.hpp"
#include "tests/support/bodies.hpp"
#include "tests/support/random_inputs.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::coupling_test {
namespace {

using test::brick;
using test::Inputs;
using test::seeds;
using test::tolerance;

CouplingTarget resting_at(const Pose& X_WT) {
  return {X_WT.position, X_WT.rotation, Vector3d::Zero(), Vector3d::Zero()};
}

Loads held(const Coupling& coupling, const RigidBody& body, const CouplingTarget& target) {
  Loads loads;
  loads.coupling = &coupling;
  loads.target = target;
  loads.coupling_at_start = coupling_force(coupling, body, target);
  return loads;
}

// 300 N/m on 2 kg, 0.1 N m/rad on principal inertias 13/6, 10/6, 5/6: b = 2 sqrt(600), B_i = 2 sqrt(0.1 I_i).
TEST(Coupling, IsCriticallyDamped) {
  const RigidBody body = brick(2, {1, 2, 3});
  const Coupling c = make_coupling(body, 1e-3, {300, 0.1}, true);
  EXPECT_EQ(c.stiffness, 300);
  EXPECT_EQ(c.angular_stiffness, 0.1);
  EXPECT_LE(std::abs(c.damping - 2 * std::sqrt(600)), tolerance(4 * 49 * 0x1p-53));
  const Vector3d B(2 * std::sqrt(1.3 / 6), 2 * std::sqrt(1.0 / 6), 2 * std::sqrt(0.5 / 6));
  EXPECT_LE((c.angular_damping_B - Matrix3d(B.asDiagonal())).norm(), tolerance(32 * 0x1p-52));
}

// A ratio scales both dampers, and what they use of the stability budget: x^2 + 4 zeta x of at most 2.
TEST(Coupling, IsDampedByTheRatioAskedFor) {
  const RigidBody body = brick(2, {1, 2, 3});
  const Coupling critical = make_coupling(body, 1e-3, {300, 0.1}, true);
  for (const double zeta : {0.0, 0.25, 2.0}) {
    CouplingLimits limits{300, 0.1};
    limits.damping_ratio = zeta;
    const Coupling c = make_coupling(body, 1e-3, limits, true);
    EXPECT_EQ(c.damping, zeta * critical.damping);
    EXPECT_EQ(c.angular_damping_B, zeta * critical.angular_damping_B);
    limits.stiffness_max = 1e9;
    const Coupling limited = make_coupling(body, 1e-3, limits, true);
    const double x = 1e-3 * std::sqrt(limited.stiffness / body.mass);
    EXPECT_LE(std::abs(x * x + 4 * zeta * x - kCouplingBudget), tolerance(1e-12));
    EXPECT_LE(std::abs(limited.budget_used - kCouplingBudget), tolerance(1e-12));
  }
}

// Released at rest 10 mm from its target, a critically damped body follows d0 (1 + w t) e^(-w t). Both integrators are
// of first order: their error is bounded by a constant times w dt d0, here 1e-2 d0 * 0.5 (0.37 is the largest slope in
// w t).
class Convergence : public testing::TestWithParam<StepWork (*)(RigidBody&, const Loads&, double, double)> {};
TEST_P(Convergence, FollowsTheClosedFormWithoutOvershoot) {
  const double dt = 1e-3, d0 = 0.01, w = 10;  // w = sqrt(k/m)
  RigidBody body = brick(2, {0.1, 0.2, 0.3});
  const Coupling c = make_coupling(body, dt, {w * w * body.mass, 0.1}, true);
  body.p_WC = {-d0, 0, 0};
  double worst = 0;
  for (int i = 1; i <= 3000; ++i) {
    (void)GetParam()(body, held(c, body, resting_at({})), dt, 1);
    const double t = i * dt, expected = -d0 * (1 + w * t) * std::exp(-w * t);
    worst = std::max(worst, std::abs(body.p_WC.x() - expected));
    ASSERT_LE(body.p_WC.x(), tolerance(1e-15)) << "overshoot in frame " << i;
  }
  EXPECT_LE(worst, tolerance(0.5 * w * dt * d0));
  EXPECT_LE(std::abs(body.p_WC.x()), tolerance(d0 * 1e-10));  // e^-30 (1 + 30) = 3e-12
}
TEST_P(Convergence, TurnsTheBodyIntoPlaceFromNearlyHalfATurn) {
  RigidBody body = brick(0.2, {0.1, 0.2, 0.3});
  const Coupling c = make_coupling(body, 1e-3, {300, 0.1}, true);
  const CouplingTarget target = resting_at({{0, 0, 0}, rotation_from_vector({1.5, -2, 1.5})});
  for (int i = 0; i < 4000; ++i) (void)GetParam()(body, held(c, body, target), 1e-3, 1);
  EXPECT_LE(vector_from_rotation(target.R_WB * body.R_WB.conjugate()).norm(), tolerance(1e-9));
  EXPECT_LE(body.omega.norm(), tolerance(1e-8));
}
INSTANTIATE_TEST_SUITE_P(BothIntegrators, Convergence, testing::Values(step_semi_implicit, step_implicit));

// The rule of coupling.hpp at all extremes that a scenario may ask for. The budget used is compared to a few roundings.
TEST(CouplingBudget, StaysBelowItsLimitAtEveryMassStepAndStiffness) {
  for (const double mass : {1e-9, 1e-3, 1.0, 1e9})
    for (const double size : {1e-4, 0.1, 1e3})
      for (const double dt : {1e-6, 1e-3, 1.0})
        for (const double stiffness : {1e-3, 300.0, 1e12}) {
          const RigidBody body = brick(mass, size * Vector3d(1e-4, 1, 2));
          const Coupling c = make_coupling(body, dt, {stiffness, stiffness}, true);
          ASSERT_LE(c.budget_used, kCouplingBudget * (1 + tolerance(64 * 0x1p-53)));
          ASSERT_GT(c.stiffness, 0);
          ASSERT_LE(c.stiffness, stiffness);
          ASSERT_GT(c.angular_stiffness, 0);
          ASSERT_LE(c.angular_stiffness, stiffness);
          const Coupling implicit = make_coupling(body, dt, {stiffness, stiffness}, false);
          EXPECT_EQ(implicit.stiffness, stiffness);
          EXPECT_EQ(implicit.budget_used, 0) << "it takes from explicit forces what it does not need";
        }
}

// With the greatest stiffness that the rule allows, any body of any size comes to rest at its target; the slowest
// rotation of a needle (principal inertias 1 : 1e6) takes the longest: w dt = 0.449 / 1000, e^-(0.449 * 100) of 1e5
// steps.
TEST(CouplingBudget, ConvergesWhereTheRuleLimitsIt) {
  for (const double mass : {1e-9, 1e9})
    for (const double dt : {1e-6, 1.0}) {
      RigidBody body = brick(mass, {1e-6, 1e-6, 0.1});
      const Coupling c = make_coupling(body, dt, {1e30, 1e30}, true);
      ASSERT_LE(std::abs(c.budget_used - kCouplingBudget), tolerance(1e-9)) << "the rule did not limit this coupling";
      const CouplingTarget target = resting_at({{0.1, 0, 0}, rotation_from_vector({0.3, 0.5, -0.4})});
      for (int i = 0; i < 100000; ++i) (void)step_semi_implicit(body, held(c, body, target), dt);
      ASSERT_TRUE(body.is_finite());
      EXPECT_LE((body.p_WC - target.p_WC).norm(), tolerance(1e-12)) << mass << " kg, " << dt << " s";
      EXPECT_LE(vector_from_rotation(target.R_WB * body.R_WB.conjugate()).norm(), tolerance(1e-9)) << mass << " " << dt;
    }
}

TEST(CouplingForce, PullsAndTurnsTowardsTheTarget) {
  RigidBody body = brick(2, {1, 2, 3});
  const Coupling c = make_coupling(body, 1e-3, {300, 0.1}, true);
  CouplingTarget target = resting_at({{0.01, 0, 0}, rotation_from_vector({0, 0, 0.2})});
  target.v_C = {0, 0.5, 0};
  target.omega = {0, 0, 0.25};
  const CouplingForce f = coupling_force(c, body, target);
  EXPECT_LE((f.spring.force - Vector3d(3, 0, 0)).norm(), tolerance(4 * 0x1p-52));
  EXPECT_LE((f.spring.torque - Vector3d(0, 0, 0.02)).norm(), tolerance(4 * 0x1p-53));
  EXPECT_LE((f.damper.force - Vector3d(0, 0.5 * c.damping, 0)).norm(), tolerance(4 * 24 * 0x1p-53));
  EXPECT_LE((f.damper.torque - Vector3d(0, 0, 0.25 * c.angular_damping_B(2, 2))).norm(), tolerance(1e-15));
  EXPECT_EQ(f.total().force, f.spring.force + f.damper.force);
  EXPECT_LE(std::abs(coupling_energy(c, coupling_force(c, body, target)) - (0.5 * 300 * 1e-4 + 0.5 * 0.1 * 0.04)),
            tolerance(1e-16));
}

// Far from its target a body feels exactly the limits, towards the target, whichever integrator moves it.
TEST(CouplingForce, IsCutToItsLimits) {
  CouplingLimits limits{300, 0.1};
  limits.force_max = 2;
  limits.torque_max = 0.004;
  for (const auto step : {step_semi_implicit, step_implicit}) {
    RigidBody body = brick(2, {1, 2, 3});
    const Coupling c = make_coupling(body, 1e-3, limits, true);
    const CouplingTarget target = resting_at({{0.3, 0.4, 0}, rotation_from_vector({0, 0, 1.5})});
    const StepWork work = step(body, held(c, body, target), 1e-3, 1);
    EXPECT_LE((work.coupling.force - Vector3d(1.2, 1.6, 0)).norm(), tolerance(1e-13));
    EXPECT_LE((work.coupling.torque - Vector3d(0, 0, 0.004)).norm(), tolerance(1e-16));
    EXPECT_LE((body.v_C - 1e-3 / 2 * Vector3d(1.2, 1.6, 0)).norm(), tolerance(1e-15));
  }
}

// The damper's axes turn with the body: the torque in body axes does not depend on where the pair stands in the world.
TEST(CouplingForce, DoesNotDependOnTheWorldsAxes) {
  for (const std::uint64_t seed : seeds(200)) {
    SCOPED_TRACE(seed);
    Inputs in(seed);
    RigidBody body = brick(2, {1, 2, 3});
    body.set_pose(in.pose(1));
    body.omega = in.vector(3);
    CouplingTarget target{in.vector(1), in.rotation(), in.vector(2), in.vector(2)};
    const Coupling c = make_coupling(body, 1e-3, {300, 0.1}, true);
    const Wrench here = coupling_force(c, body, target).total();
    const Pose X = in.pose(1);
    body.set_pose(X * body.pose());
    body.omega = X.rotation * body.omega;
    target = {X * target.p_WC, X.rotation * target.R_WB, X.rotation * target.v_C, X.rotation * target.omega};
    const Wrench there = coupling_force(c, body, target).total();
    ASSERT_LE((there.force - X.rotation * here.force).norm(), tolerance(1e-11));  // 1000 N, twenty roundings
    // Near half a turn the error vector may flip its sign by a rounding; a hundredth of a radian below it cannot.
    if (vector_from_rotation(target.R_WB * body.R_WB.conjugate()).norm() < 3.13) {
      ASSERT_LE((there.torque - X.rotation * here.torque).norm(), tolerance(1e-12));
    }
  }
}

}  // namespace
}  // namespace verisim::coupling_test
