// A hand at a virtual wall by the engine's devices and coupling, against the sampled wall as a recurrence of its own
// (as tests/oracles/virtual_wall_test.cpp has it, with a delay) and against the formulas of ORACLES section 2.
#include "engine/stability/hand_on_wall.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "tests/length.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::stability::hand_on_wall_test {
namespace {

using test::tolerance;

/// Largest eigenvalue (absolute) of a mass with damping b whose motion between samples is exact, against the force u =
/// -K x - B (x - x_before)/T of `late` periods ago, held over the period. State: x, v, the samples before.
double spectral_radius(const HandOnWall& h, double K) {
  const double T = h.period, b = h.damping, B = h.wall_damping;
  const double decay = std::exp(-b * T / h.mass);
  const double x_by_v = h.mass / b * (1 - decay);
  const double x_by_u = T / b - h.mass / (b * b) * (1 - decay);
  const double v_by_u = (1 - decay) / b;
  const int late = static_cast<int>(h.periods_late), n = 3 + late;
  const auto sample = [](int age) { return age == 0 ? 0 : 1 + age; };  // where x of so many periods ago is
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  A(0, 0) = 1;
  A(0, 1) = x_by_v;
  A(1, 1) = decay;
  for (const auto& [age, by] : {std::pair{late, -(K + B / T)}, std::pair{late + 1, B / T}}) {
    A(0, sample(age)) += x_by_u * by;
    A(1, sample(age)) += v_by_u * by;
  }
  A(2, 0) = 1;
  for (int i = 3; i < n; ++i) A(i, i - 1) = 1;
  return A.eigenvalues().cwiseAbs().maxCoeff();
}

double bound_by_eigenvalues(const HandOnWall& h) {
  double stable = 1, unstable = 1e5;
  for (int i = 0; i < 60; ++i) {
    const double K = (stable + unstable) / 2;
    (spectral_radius(h, K) < 1 ? stable : unstable) = K;
  }
  return stable;
}

// The recurrence itself: the worked numbers of ORACLES section 2.
TEST(Recurrence, GivesTheWorkedStiffness) {
  HandOnWall h;
  h.wall_damping = 0.4;
  EXPECT_LE(std::abs(bound_by_eigenvalues(h) - 2398), tolerance(0.5));
  h.mass = 0.04;
  EXPECT_LE(std::abs(bound_by_eigenvalues(h) - 2384), tolerance(0.5));
}

// A frame of T/n stands for half of one less of the period's delay: 1/n at most, where nothing else is late; bisection
// to 0.2 %. At 0.04 kg, where K < (b + B)/(T/2 + t_d) departs from it, the recurrence holds as well.
TEST(HandOnWall, IsStableUpToTheRecurrencesStiffness) {
  for (const double mass : test::by_length<std::vector<double>>({0.04}, {0.04, 0.4}, {0.04, 0.1, 0.4, 2.0}))
    for (const unsigned late : test::some_of({0U, 2U})) {
      SCOPED_TRACE(testing::Message() << mass << " kg, " << late << " periods late");
      HandOnWall h;
      h.mass = mass;
      h.wall_damping = 0.4;
      h.periods_late = late;
      const auto found = bound_of(h);
      ASSERT_TRUE(found);
      const double delay_of_a_frame = 0.5 / h.frames / (0.5 + late);
      EXPECT_LE(std::abs(*found / bound_by_eigenvalues(h) * (1 - delay_of_a_frame) - 1), tolerance(0.006));
    }
}

// Colgate and Schenkel: b > K T/2 + |B|. Abbott and Okamura: K <= min(2 b/T, 2 f_c/Delta).
TEST(HandOnWall, IsPassiveUpToTheFormulas) {
  for (const double B : test::some_of({0.4, 0.0, -0.0}))
    for (const double T : test::some_of({2e-3, 5e-4})) {
      HandOnWall h;
      h.wall_damping = B;
      h.period = T;
      const auto found = passive_bound_of(h, {1e-3});
      ASSERT_TRUE(found);
      EXPECT_LE(std::abs(*found / (2 * (h.damping - B) / T) - 1), tolerance(0.002));
    }
  for (const double friction : test::some_of({0.01, 0.3})) {
    HandOnWall h;
    h.damping = 2;
    h.resolution = 55e-6;
    h.friction = friction;
    const auto found = passive_bound_of(h, {1e-4 * h.resolution, 1.001 * h.resolution, 1});
    ASSERT_TRUE(found);
    EXPECT_LE(std::abs(*found / std::min(2 * 2 / 1e-3, 2 * friction / 55e-6) - 1), tolerance(0.006));
  }
}

// "The two criteria are different promises": between them the wall is stable and not passive.
TEST(HandOnWall, MayBeStableWithoutBeingPassive) {
  HandOnWall h;
  h.wall_damping = 0.4;
  h.stiffness = 1600;
  EXPECT_EQ(hold(h).outcome, Outcome::stable);
  EXPECT_LT(energy_taken(h, 1e-3, 0), 0);
  h.stiffness = 700;
  EXPECT_GT(energy_taken(h, 1e-3, 0), 0);
}

// Without friction what the encoder rounds keeps a soft wall humming: bounded, and for ever. A little friction ends it.
TEST(HandOnWall, HumsBehindStepsOfTheEncoderWithoutFriction) {
  HandOnWall h;
  h.damping = 2;
  h.resolution = 55e-6;
  h.frames = 10;
  h.stiffness = 316;
  for (const double friction : test::some_of({0.0, 0.01})) {
    h.friction = friction;
    EXPECT_EQ(hold(h, test::by_length(5U, 8U, 8U)).outcome, friction == 0 ? Outcome::limit_cycle : Outcome::stable);
  }
}

// Who looks four times as long finds the same bound.
TEST(HandOnWall, HasABoundThatDoesNotDependOnHowLongOneLooks) {
  HandOnWall h;
  h.mass = 0.1;
  for (const double by : {0.99, 1.01}) {
    h.stiffness = by * bound_by_eigenvalues(h) / (1 - 1.0 / h.frames);
    for (const unsigned blocks : test::some_of({6U, 8U, 10U}))
      EXPECT_EQ(hold(h, blocks).outcome, by < 1 ? Outcome::stable : Outcome::diverged) << by << " " << blocks;
  }
}

}  // namespace
}  // namespace verisim::stability::hand_on_wall_test
