// Bodies that turn and on which no torque acts, against closed forms: how far off a step is, and that it stays there.
#include "engine/dynamics/free_rotation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/base/pinned_math.hpp"
#include "engine/dynamics/integrator.hpp"
#include "tests/support/bodies.hpp"
#include "tests/support/random_inputs.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::free_rotation_test {
namespace {

using test::angular_momentum;
using test::brick;
using test::Inputs;
using test::seeds;
using test::tolerance;

constexpr double kDegree = pinned::kPi / 180;

/// Complete elliptic integral of the first kind, K(m) with parameter m = k^2, by the arithmetic-geometric mean.
double elliptic_K(double m) {
  double a = 1, b = std::sqrt(1 - m);
  for (int i = 0; i < 40; ++i) {
    const double mean = 0.5 * (a + b);
    b = std::sqrt(a * b);
    a = mean;
  }
  return pinned::kPi / (2 * a);
}

/// s: after this time a free body's angular momentum is again where it was in the body (Landau, Lifshitz: Mechanics,
/// section 37).
double period(const RigidBody& body) {
  const Vector3d& I = body.principal_moments;
  const double L2 = angular_momentum(body).squaredNorm();
  const double E2 = body.omega.dot(angular_momentum(body));  // twice the energy
  double about_3 = (I[2] - I[1]) * (L2 - E2 * I[0]);
  double about_1 = (I[1] - I[0]) * (E2 * I[2] - L2);
  if (L2 < E2 * I[1]) std::swap(about_3, about_1);  // circles axis 1, not axis 3
  return 4 * elliptic_K(about_1 / about_3) * std::sqrt(I.prod() / about_3);
}

Vector3d momentum_in_body(const RigidBody& body) {
  return body.R_WB.conjugate() * angular_momentum(body);
}

RigidBody random_spinning_body(std::uint64_t seed, double omega_max) {
  Inputs in(seed);
  RigidBody body = brick(1, {in.between(0.01, 0.05), in.between(0.06, 0.1), in.between(0.12, 0.3)});
  body.R_WB = in.rotation();
  body.omega = in.vector(omega_max);
  return body;
}

class FreeRotation : public testing::TestWithParam<StepWork (*)(RigidBody&, const Loads&, double, double)> {
 protected:
  static void advance(RigidBody& body, double dt, long steps) {
    for (long i = 0; i < steps; ++i) (void)GetParam()(body, {}, dt, 1);
  }
};

// The oracle's own check: where the two small-angle limits are known. A symmetric body's momentum circles its axis at
// (1/I3 - 1/I1) L3.
TEST(Period, OfASymmetricBodyIsItsClosedForm) {
  RigidBody top = brick(1, {0.1, 0.1, 0.3});
  top.omega = {3, 0, 4};
  const double rate = (1 / top.inertia_B(2, 2) - 1 / top.inertia_B(0, 0)) * top.inertia_B(2, 2) * 4;
  EXPECT_LE(std::abs(period(top) * std::abs(rate) / pinned::kFullTurn - 1), tolerance(1e-9));
}

// After one period of Jacobi's elliptic functions L is back where it was in the body. Divided into twice as many steps,
// it is back four times as exactly; errors of higher order and rounding leave 2 % of that. Steps are of at most 1/64
// rad.
TEST_P(FreeRotation, IsOfSecondOrder) {
  for (const std::uint64_t seed : seeds(50)) {
    SCOPED_TRACE(seed);
    const RigidBody start = random_spinning_body(seed, 20);
    const double T = period(start);
    const auto error_with = [&](long steps) {
      RigidBody body = start;
      advance(body, T / static_cast<double>(steps), steps);
      return (momentum_in_body(body) - momentum_in_body(start)).norm() / angular_momentum(start).norm();
    };
    const long steps = 64 * std::lround(std::max(10.0, T * start.omega.norm()));
    const double coarse = error_with(steps), fine = error_with(2 * steps);
    EXPECT_LE(coarse, tolerance(0x1p-12));
    EXPECT_LE(std::abs(coarse / fine - 4), tolerance(0.08));
  }
}

// Forward, then with the velocity turned round, and the body is where it began: to the roundings of 2000 steps.
TEST_P(FreeRotation, IsSymmetricInTime) {
  for (const std::uint64_t seed : seeds(20)) {
    SCOPED_TRACE(seed);
    const RigidBody start = random_spinning_body(seed, 30);
    RigidBody body = start;
    advance(body, 1e-3, 1000);
    EXPECT_GT(body.R_WB.angularDistance(start.R_WB), 0.01);
    body.omega = -body.omega;
    advance(body, 1e-3, 1000);
    EXPECT_LE(body.R_WB.angularDistance(start.R_WB), tolerance(1e-10));
    EXPECT_LE((body.omega + start.omega).norm() / start.omega.norm(), tolerance(1e-10));
  }
}

// A symmetric body turns exactly, however large the step: its axis goes round L at |L| / I_across, at its angle.
TEST_P(FreeRotation, OfASymmetricTopIsExactAtAnyStep) {
  for (const double height : {0.02, 0.3}) {  // a disc and a rod
    for (const double dt : {1e-4, 1e-3, 0.1}) {
      RigidBody top = brick(1, {0.1, 0.1, height});
      const double across = top.inertia_B(0, 0), along = top.inertia_B(2, 2);
      const Vector3d L(0, 0, 20 * across);  // precession at 20 rad/s
      const double theta = 0.5;
      top.R_WB = rotation_from_vector({0, theta, 0});  // axis in the x-z plane
      const Vector3d axis0 = top.R_WB * Vector3d::UnitZ();
      top.omega = L / across + (1 / along - 1 / across) * axis0.dot(L) * axis0;
      const long steps = std::lround(2 / dt);
      advance(top, dt, steps);
      const Vector3d axis = top.R_WB * Vector3d::UnitZ();
      const Vector3d expected(std::sin(theta) * std::cos(40.0), std::sin(theta) * std::sin(40.0), std::cos(theta));
      EXPECT_LE((axis - expected).norm(), tolerance(static_cast<double>(steps) * 16 * 0x1p-52)) << height << ' ' << dt;
    }
  }
}

// 1 ms, 60 s, about the axis in the middle, where it tumbles.
TEST_P(FreeRotation, OfATumblingBoxDoesNotDriftInEnergy) {
  RigidBody box = brick(1, {0.1, 0.2, 0.05});
  box.omega = {5, 0.1, 0.1};
  const double before = box.kinetic_energy();
  double off = 0, turned = 1;
  for (int i = 0; i < 60'000; ++i) {
    advance(box, 1e-3, 1);
    off = std::max(off, std::abs(box.kinetic_energy() / before - 1));
    turned = std::min(turned, (box.R_WB.conjugate() * box.omega).x() / 5);
  }
  EXPECT_LT(turned, -0.9) << "it never turned over: this test would prove nothing";
  EXPECT_LE(off, tolerance(1e-6));
}

// A spin about the greatest moment, with 0.01 rad/s beside its 20: theory lets it stray by 0.03 degrees.
TEST_P(FreeRotation, AboutTheGreatestMomentIsStable) {
  RigidBody box = brick(1, {0.1, 0.2, 0.05});
  box.omega = {0.01, 0, 20};
  const Vector3d L = angular_momentum(box).normalized();
  const double before = box.kinetic_energy();
  for (int i = 0; i < 60'000; ++i) {
    advance(box, 1e-3, 1);
    ASSERT_GT((box.R_WB * Vector3d::UnitZ()).dot(L), std::cos(0.05 * kDegree)) << "step " << i;
  }
  EXPECT_LE(std::abs(box.kinetic_energy() / before - 1), tolerance(1e-9));
}

// I3/I1 = 1.5 at 20 rad/s, tilted by 10 degrees: 20 s at 1 ms.
TEST_P(FreeRotation, OfATopKeepsItsCone) {
  const double tilt = 10 * kDegree;
  RigidBody top = brick(1, {0.1, 0.1, 0.1 / std::sqrt(3)});  // (1 + 1) / (1 + 1/3) = 1.5
  top.omega = 20 * Vector3d(std::sin(tilt), 0, std::cos(tilt));
  const Vector3d L = angular_momentum(top).normalized();
  const auto cosine = [&] { return (top.R_WB * Vector3d::UnitZ()).dot(L); };
  const double before = cosine();
  ASSERT_LE(std::abs(top.principal_moments[2] / top.principal_moments[0] - 1.5), 1e-12);
  for (int i = 0; i < 20'000; ++i) {
    advance(top, 1e-3, 1);
    ASSERT_LE(std::abs(cosine() - before), tolerance(1e-11)) << "step " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(BothIntegrators, FreeRotation, testing::Values(step_semi_implicit, step_implicit));

}  // namespace
}  // namespace verisim::free_rotation_test
