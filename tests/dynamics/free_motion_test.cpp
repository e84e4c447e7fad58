// Bodies that nobody holds and that touch nothing: closed forms of mechanics. How they turn: free_rotation_test.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/dynamics/integrator.hpp"
#include "tests/length.hpp"
#include "tests/support/bodies.hpp"
#include "tests/support/random_inputs.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::free_motion_test {
namespace {

using test::angular_momentum;
using test::brick;
using test::Inputs;
using test::seeds;
using test::tolerance;

class FreeMotion : public testing::TestWithParam<StepWork (*)(RigidBody&, const Loads&, double, double)> {
 protected:
  static void step(RigidBody& body, const Loads& loads, double dt) { (void)GetParam()(body, loads, dt, 1); }
};

// Velocity first: after n steps v = n g dt and the path is g dt^2 n (n + 1)/2, that is g t (t + dt)/2. n roundings.
TEST_P(FreeMotion, FallsAsTheDiscreteClosedFormSays) {
  const double dt = 1e-3, g = 9.81;
  const int n = 2000;
  for (const double mass : {1e-9, 1.0, 1e9}) {
    RigidBody body = brick(mass, {0.1, 0.2, 0.3});
    Loads loads;
    loads.external.force = {0, 0, -mass * g};
    for (int i = 0; i < n; ++i) step(body, loads, dt);
    EXPECT_LE(std::abs(body.v_C.z() + n * g * dt), tolerance(n * 20 * 0x1p-53));
    EXPECT_LE(std::abs(body.p_WC.z() + 0.5 * g * dt * dt * n * (n + 1)), tolerance(n * 40 * 0x1p-53));
    EXPECT_EQ(body.omega, Vector3d::Zero());
  }
}

// Under a constant torque about a principal axis the angle grows as the path of a falling body does.
TEST_P(FreeMotion, SpinsUpUnderAConstantTorque) {
  const double dt = 1e-3, torque = 0.5;
  const int n = 1000;
  RigidBody body = brick(12, {1, 2, 3});  // I about z: 5 kg m^2
  Loads loads;
  loads.external.torque = {0, 0, torque};
  for (int i = 0; i < n; ++i) step(body, loads, dt);
  const double angle = vector_from_rotation(body.R_WB).z();
  EXPECT_LE(std::abs(angle - 0.5 * torque / 5 * dt * dt * n * (n + 1)), tolerance(n * 0x1p-52));
  EXPECT_LE(std::abs(body.omega.z() - n * dt * torque / 5), tolerance(n * 0x1p-52));
}

// L = I omega is kept to rounding: each step multiplies by I and by its inverse, whose product differs from 1 by the
// inertia's condition number (at most 14 here) times a few roundings.
TEST_P(FreeMotion, KeepsAngularMomentum) {
  for (const std::uint64_t seed : seeds(20)) {
    SCOPED_TRACE(seed);
    Inputs in(seed);
    RigidBody body = brick(1, {0.1, 0.2, 0.3});
    body.R_WB = in.rotation();
    body.omega = in.vector(20);
    const Vector3d before = angular_momentum(body);
    const int n = 5000;
    for (int i = 0; i < n; ++i) step(body, {}, 1e-3);
    ASSERT_LE((angular_momentum(body) - before).norm() / before.norm(), tolerance(n * 14 * 0x1p-52));
  }
}

// The header's bound: the spin energy stays below |L|^2 / (2 I_min), a needle at 1e4 rad/s with steps from 1 us to 1 s.
TEST_P(FreeMotion, ANeedleSpinningFastNeverBlowsUp) {
  for (const double dt : {1e-6, 1e-3, 1.0})
    for (const std::uint64_t seed : seeds(5)) {
      SCOPED_TRACE(seed);
      RigidBody needle = brick(1e-3, {1e-6, 1e-6, 0.1});
      needle.R_WB = Inputs(seed).rotation();
      needle.omega = 1e4 * Inputs(seed + 100).vector(1).normalized();
      const double L2 = angular_momentum(needle).squaredNorm();
      const double bound = L2 / (2 * smallest_eigenvalue(needle.inertia_B));
      for (int i = 0; i < test::by_length(2000, 10000, 20000); ++i) {
        step(needle, {}, dt);
        ASSERT_TRUE(needle.is_finite()) << "step " << i;
        // The condition number of 1e6 times the roundings of so many steps loosens the bound a little.
        ASSERT_LE(needle.kinetic_energy(), bound * (1 + tolerance(1e-5))) << "step " << i;
      }
      EXPECT_LE(std::abs(std::sqrt(angular_momentum(needle).squaredNorm() / L2) - 1), tolerance(1e-5));
      EXPECT_LE(std::abs(needle.R_WB.norm() - 1), tolerance(4 * 0x1p-53));
    }
}

INSTANTIATE_TEST_SUITE_P(BothIntegrators, FreeMotion, testing::Values(step_semi_implicit, step_implicit));

}  // namespace
}  // namespace verisim::free_motion_test
