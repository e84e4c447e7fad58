// The linearly implicit integrator against a wall: z <= 0 pushes up with stiffness k and damping b, at the body's
// centre.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "engine/dynamics/integrator.hpp"
#include "tests/length.hpp"
#include "tests/support/bodies.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::implicit_contact_test {
namespace {

using test::brick;
using test::tolerance;

struct Wall {
  double stiffness = 1000, damping = 0;
  double velocity = 0;       ///< m/s along z
  Vector3d arm = {0, 0, 0};  ///< where it touches, from the centre of mass
};

/// Loads of a wall that the body has entered by `depth` where it is touched.
Loads touching(const RigidBody& body, const Wall& wall, double depth) {
  Vector6d J;
  J << 0, 0, 1, wall.arm.cross(Vector3d::UnitZ());
  Vector6d u;
  u << body.v_C, body.omega;
  const double force = std::max(0.0, wall.stiffness * depth - wall.damping * (J.dot(u) - wall.velocity));
  Loads loads;
  loads.contact = {force * J.head<3>(), force * J.tail<3>()};
  loads.contact_stiffness = wall.stiffness * J * J.transpose();
  loads.contact_damping = wall.damping * J * J.transpose();
  loads.contact_drift = wall.stiffness * wall.velocity * J;
  return loads;
}

// One step of m v' = -k z by hand: v1 = (v0 + dt k depth/m) / (1 + dt^2 k/m); the force is that at the end of the step.
TEST(ImplicitContact, TakesTheForceAtTheEndOfTheStep) {
  RigidBody body = brick(2, {0.1, 0.1, 0.1});
  body.v_C.z() = -0.3;
  const double dt = 1e-2, k = 1000, depth = 0.01;
  const double v1 = (-0.3 + dt * k * depth / 2) / (1 + dt * dt * k / 2);
  const StepWork work = step_implicit(body, touching(body, {.stiffness = k}, depth), dt);
  EXPECT_LE(std::abs(body.v_C.z() - v1), tolerance(8 * 0x1p-53));
  EXPECT_LE(std::abs(work.contact.force.z() - k * (depth - dt * v1)), tolerance(16 * 16 * 0x1p-53));
  EXPECT_LE(std::abs(work.contact.force.z() - 2 * (v1 + 0.3) / dt), tolerance(64 * 0x1p-43)) << "Newton's second law";
}

TEST(ImplicitContact, ThatLetsGoDoesNotPull) {
  const double dt = 1e-2;
  for (const double damping : {0.0, 5.0}) {
    RigidBody body = brick(2, {0.1, 0.1, 0.1});
    body.v_C.z() = 0.5;  // leaves 5 mm in a step; 1 mm deep
    const StepWork work = step_implicit(body, touching(body, {.damping = damping}, 1e-3), dt);
    EXPECT_EQ(work.contact.force, Vector3d::Zero());
    EXPECT_LE(std::abs(body.v_C.z() - 0.5), tolerance(2 * 0x1p-53));  // m v / m
    EXPECT_EQ(work.contact_work, 0);
  }
}

// A damper that is stronger than the spring makes the force at the start zero: nothing may hold the body back.
TEST(ImplicitContact, WithoutForceAtTheStartDoesNotPull) {
  RigidBody body = brick(2, {0.1, 0.1, 0.1});
  body.v_C.z() = 0.1;
  const Loads loads = touching(body, {.damping = 100}, 1e-3);
  ASSERT_EQ(loads.contact.force.z(), 0);
  const StepWork work = step_implicit(body, loads, 1e-3);
  EXPECT_EQ(work.contact.force.z(), 0);
  EXPECT_LE(std::abs(body.v_C.z() - 0.1), tolerance(2 * 0x1p-53));  // m v / m
}

// Carried up by a rising platform, a body ends up with its velocity (and not faster: no energy from the linearisation).
TEST(ImplicitContact, FollowsAWallThatMoves) {
  const double dt = 1e-3;
  const Wall wall{.stiffness = 1e6, .damping = 2 * std::sqrt(1e6 * 2), .velocity = 0.2};
  RigidBody body = brick(2, {0.1, 0.1, 0.1});
  for (int i = 0; i < 2000; ++i) {
    const double depth = wall.velocity * i * dt - body.p_WC.z();
    Loads loads = depth >= 0 ? touching(body, wall, depth) : Loads();
    loads.external.force.z() = -2 * 9.81;
    (void)step_implicit(body, loads, dt);
    ASSERT_LE(body.v_C.z(), wall.velocity + 2 * 9.81 * dt) << i;
  }
  EXPECT_LE(std::abs(body.v_C.z() - wall.velocity), tolerance(1e-9));
}

// Rests under gravity at m g / k however stiff the wall is (backward Euler). At half of critical damping and w =
// sqrt(k/m) of at least 10 rad/s, three seconds leave e^-15 of the impact; a body that last bounced stands within one
// step's fall.
TEST(ImplicitContact, RestsOnAWallOfAnyStiffness) {
  for (const double mass : test::some_of({1e-9, 1.0, 1e9}))
    for (const double w_squared : {1e2, 1e8, 1e15, 1e17})
      for (const double dt : {1e-4, 1e-2}) {
        SCOPED_TRACE(testing::Message() << mass << " kg, k/m " << w_squared << " 1/s^2, " << dt << " s");
        const Wall wall{.stiffness = w_squared * mass, .damping = std::sqrt(w_squared) * mass};
        RigidBody body = brick(mass, {0.1, 0.1, 0.1});
        for (int i = 0; i < 30000; ++i) {
          const double depth = -body.p_WC.z();
          Loads loads = depth >= 0 ? touching(body, wall, depth) : Loads();
          loads.external.force.z() = -mass * 9.81;
          (void)step_implicit(body, loads, dt);
        }
        const double rest = 9.81 / w_squared;
        EXPECT_LE(std::abs(body.p_WC.z() + rest), tolerance(1e-6 * rest + 9.81 * dt * dt));
      }
}

// Off-centre contact on a small light body: a Cholesky factor of M + dt^2 K that spans fifteen decades must still push
// out, never in, and give no energy.
TEST(ImplicitContact, OffTheCentreOfAFeatherStaysFiniteAndGivesNoEnergy) {
  for (const double k : {1e3, 1e6, 1e9, 1e12}) {
    RigidBody body = brick(1e-9, {1e-3, 2e-3, 3e-3});
    body.v_C.z() = -0.1;
    const double depth = 1e-6;
    const double before = body.kinetic_energy() + 0.5 * k * depth * depth;
    (void)step_implicit(body, touching(body, {.stiffness = k, .arm = {3e-4, 7e-4, 1e-3}}, depth), 1e-3);
    ASSERT_TRUE(body.is_finite()) << k;
    EXPECT_LE(body.kinetic_energy(), before * (1 + tolerance(1e-9))) << k;
  }
}

// The same step told in metres and in units 1024 times smaller (a power of two: scaling itself rounds nothing) moves
// the same: nowhere are forces and torques compared as bare numbers. The body touches at two points 0.1 m to either
// side; the force would turn round within the step, the torque would grow. Masses stay; lengths and forces take the
// factor once, torques and inertia twice.
TEST(ImplicitContact, DoesNotDependOnTheUnitOfLength) {
  const auto step_in = [](double unit) {
    RigidBody body = brick(1000, unit * Vector3d(0.4, 0.4, 0.4));
    body.v_C = unit * Vector3d(0, 0, 1);
    body.omega = {0, 50, 0};  // moves the point at +x down: deeper
    Loads loads = touching(body, {.arm = unit * Vector3d(0.1, 0, 0)}, unit * 1e-3);
    const Loads other = touching(body, {.arm = unit * Vector3d(-0.1, 0, 0)}, 0);
    loads.contact += other.contact;
    loads.contact_stiffness += other.contact_stiffness;
    const StepWork work = step_implicit(body, loads, 1e-3);
    return std::pair(Vector3d(work.contact.force / unit), Vector3d(body.omega));
  };
  EXPECT_EQ(step_in(1).first, step_in(1024).first);
  EXPECT_EQ(step_in(1).second, step_in(1024).second);
}

}  // namespace
}  // namespace verisim::implicit_contact_test
