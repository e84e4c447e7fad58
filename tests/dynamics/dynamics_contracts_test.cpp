// The doors of engine/dynamics: what a body, a coupling and a step do not take.
#include <gtest/gtest.h>

#include <limits>

#include "engine/dynamics/free_rotation.hpp"
#include "engine/dynamics/integrator.hpp"
#include "tests/support/bodies.hpp"
#include "tests/support/broken.hpp"

namespace verisim::dynamics_contracts_test {
namespace {

using test::brick;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kStep = 1e-3;
const Quaterniond kTwiceUnit(2, 0, 0, 0);

/// Not symmetric: the upper right corner is off by a millionth of the largest entry.
template <typename Square>
Square lopsided() {
  Square m = Square::Identity();
  m(0, m.cols() - 1) = 1e-6;
  return m;
}

TEST(BodyDeathTest, HasAPlaceAndATurn) {
  RigidBody body = brick(1, {1, 2, 3});
  EXPECT_BROKEN(body.set_pose({{0, kNaN, 0}, Quaterniond::Identity()}), "X_WB.position.allFinite()");
  EXPECT_BROKEN(body.set_pose({{0, 0, 0}, kTwiceUnit}), "is_unit(X_WB.rotation)");
  EXPECT_BROKEN(RigidBody().inverse_mass_matrix(), "mass > 0");
}

TEST(MatrixDeathTest, OfABodyIsFiniteAndSymmetric) {
  EXPECT_BROKEN(square_root(Matrix3d::Constant(kNaN)), "m.allFinite()");
  EXPECT_BROKEN(square_root(lopsided<Matrix3d>()), "is_symmetric(m)");
  EXPECT_BROKEN(smallest_eigenvalue(Matrix3d::Constant(kInfinity)), "m.allFinite()");
  EXPECT_BROKEN(smallest_eigenvalue(lopsided<Matrix3d>()), "is_symmetric(m)");
}

TEST(CouplingDeathTest, NeedsAStepAMassAndLimits) {
  const RigidBody body = brick(1, {1, 2, 3});
  for (const double dt : {0.0, -kStep, kNaN, kInfinity})
    EXPECT_BROKEN(make_coupling(body, dt, {}, true), "is_positive(dt)");
  EXPECT_BROKEN(make_coupling(RigidBody(), kStep, {}, true), "is_positive(body.mass)");
  RigidBody point = body;
  point.inertia_B.setZero();
  EXPECT_BROKEN(make_coupling(point, kStep, {}, true), "inertia_min > 0");
  const auto with = [&](double CouplingLimits::*member, double value) {
    CouplingLimits limits;
    limits.*member = value;
    return make_coupling(body, kStep, limits, true);
  };
  EXPECT_BROKEN(with(&CouplingLimits::stiffness_max, kInfinity), "is_not_negative(limits.stiffness_max)");
  EXPECT_BROKEN(with(&CouplingLimits::angular_stiffness_max, -1), "is_not_negative(limits.angular_stiffness_max)");
  EXPECT_BROKEN(with(&CouplingLimits::force_max, 0), "limits.force_max > 0");
  EXPECT_BROKEN(with(&CouplingLimits::torque_max, kNaN), "limits.torque_max > 0");
  EXPECT_BROKEN(with(&CouplingLimits::damping_ratio, -1), "is_not_negative(limits.damping_ratio)");
}

TEST(CouplingDeathTest, PullsTowardsARotation) {
  const RigidBody body = brick(1, {1, 2, 3});
  const Coupling coupling = make_coupling(body, kStep, {}, true);
  const CouplingTarget target{{0, 0, 0}, kTwiceUnit, {0, 0, 0}, {0, 0, 0}};
  EXPECT_BROKEN(coupling_force(coupling, body, target), "is_unit(target.R_WB)");
}

/// The four doors through which a body's step goes.
class StepDeathTest : public ::testing::TestWithParam<void (*)(RigidBody&, const Loads&, double)> {
 protected:
  void take() { GetParam()(body_, loads_, dt_); }
  RigidBody body_ = brick(1, {1, 2, 3});
  Loads loads_;
  double dt_ = kStep;
};

TEST(FreeRotationDeathTest, TurnsABodyThatHasMoments) {
  RigidBody body = brick(1, {1, 2, 3});
  EXPECT_BROKEN(turned_freely(body, Vector3d::UnitX(), 0), "is_positive(dt)");
  EXPECT_BROKEN(turned_freely(RigidBody(), Vector3d::UnitX(), kStep), "I[0] > 0");
  body.R_WB = kTwiceUnit;
  EXPECT_BROKEN(turned_freely(body, Vector3d::UnitX(), kStep), "is_unit(body.R_WB)");
}

TEST(ScaleDeathTest, ScalesContactsByAFraction) {
  for (const double scale : {-0.1, 1.1, kNaN}) {
    RigidBody body = brick(1, {1, 2, 3});
    EXPECT_BROKEN(step_semi_implicit(body, {}, kStep, scale), "is_fraction(contact_scale)");
    EXPECT_BROKEN(step_implicit(body, {}, kStep, scale), "is_fraction(contact_scale)");
  }
}

TEST_P(StepDeathTest, NeedsTime) {
  for (const double dt : {0.0, -kStep, kNaN, kInfinity}) {
    dt_ = dt;
    EXPECT_BROKEN(take(), "is_positive(dt)");
  }
}
TEST_P(StepDeathTest, NeedsABodyWithAMass) {
  body_.mass = 0;
  EXPECT_BROKEN(take(), "body.mass > 0");
}
TEST_P(StepDeathTest, StartsFromAFiniteState) {
  body_.v_C.x() = kNaN;
  EXPECT_BROKEN(take(), "body.is_finite()");
}
TEST_P(StepDeathTest, StartsFromARotation) {
  body_.R_WB = kTwiceUnit;
  EXPECT_BROKEN(take(), "is_unit(body.R_WB)");
}
TEST_P(StepDeathTest, TakesSymmetricMatricesOfContact) {
  loads_.contact_stiffness = lopsided<Matrix6d>();
  EXPECT_BROKEN(take(), "is_symmetric(loads.contact_stiffness)");
  loads_.contact_stiffness.setZero();
  loads_.contact_damping = lopsided<Matrix6d>();
  EXPECT_BROKEN(take(), "is_symmetric(loads.contact_damping)");
}
// A run that diverges ends with an error that names the body, not with a broken promise: simulation asks is_finite().
TEST_P(StepDeathTest, PassesOnLoadsThatAreNotFinite) {
  loads_.contact.force.x() = kInfinity;
  loads_.contact_stiffness = Matrix6d::Constant(kNaN);
  take();
  loads_.contact_stiffness = Matrix6d::Constant(kInfinity);
  if (body_.is_finite()) take();
}
INSTANTIATE_TEST_SUITE_P(
    AllSteps, StepDeathTest,
    ::testing::Values(
        [](RigidBody& body, const Loads& loads, double dt) { (void)step_semi_implicit(body, loads, dt); },
        [](RigidBody& body, const Loads& loads, double dt) { (void)step_implicit(body, loads, dt); },
        [](RigidBody& body, const Loads& loads, double dt) { (void)contact_work_semi_implicit(body, loads, dt); },
        [](RigidBody& body, const Loads& loads, double dt) { (void)contact_work_implicit(body, loads, dt); }));

TEST(ImplicitStepDeathTest, IsBegunBeforeItIsEnded) {
  RigidBody body = brick(1, {1, 2, 3});
  const Vector6d u1 = Vector6d::Zero();
  EXPECT_BROKEN(end_implicit(body, {}, {}, u1, {}, kStep), "!step.A.isZero(0)");
  const ImplicitStep step = begin_implicit(body, {}, kStep);
  EXPECT_BROKEN(end_implicit(body, {}, step, u1, {}, 0), "is_positive(dt)");
}

TEST(ScaleDeathTest, LiesBetweenNothingAndAll) {
  EXPECT_BROKEN(passive_scale(-1e-9, {1, 1, 0}), "!(available < 0)");
  EXPECT_BROKEN((ContactWork{1, 1, 0}.at(1.5)), "is_fraction(scale)");
  const Matrix6d none = Matrix6d::Zero();
  EXPECT_BROKEN(wrench_at_end({}, none, none, Vector6d::Zero(), {kNaN, {}, {}}, kStep), "is_fraction(end.scale)");
  EXPECT_BROKEN(wrench_at_end({}, none, none, Vector6d::Zero(), {}, 0), "is_positive(dt)");
}

// inf - inf is no number, and a scale that is no number would go into every body of the group.
TEST(PassiveScale, IsZeroForWorkBeyondDoublePrecision) {
  EXPECT_EQ(passive_scale(1, {kInfinity, kInfinity, kInfinity}), 0);
  EXPECT_EQ(passive_scale(1, {kInfinity, 1, kNaN}), 0);
}

}  // namespace
}  // namespace verisim::dynamics_contracts_test
