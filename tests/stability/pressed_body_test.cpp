// A body on a wall by the engine's contacts, against ORACLES section 2 (discrete mass-spring-damper).
#include "engine/stability/pressed_body.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/length.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::stability::pressed_body_test {
namespace {

// "Stable if and only if k dt^2/m + 2 b dt/m < 4": found within 1 %.
TEST(PressedBody, IsStableBelowFourOnly) {
  for (const double damping_ratio : test::by_length<std::vector<double>>({0.5}, {0.05, 0.5}, {0.05, 0.2, 0.5, 2})) {
    PressedBody body;
    body.damping_ratio = damping_ratio;
    const auto bound = bound_of(body);
    ASSERT_TRUE(bound);
    EXPECT_LE(std::abs(bound->budget / 4 - 1), test::tolerance(0.01)) << damping_ratio;
  }
}

/// Ten times the stiffness at the bound.
PressedBody too_stiff() {
  PressedBody body;
  body.stiffness = 10 * 3.3e6 / 49;
  return body;
}

TEST(PressedBody, IsThrownByTenTimesThatStiffness) {
  EXPECT_EQ(press(too_stiff()).outcome, Outcome::diverged);
}

// "Backward Euler: always."
TEST(PressedBody, IsStableUnderBackwardEulerAtAnyStiffness) {
  PressedBody body = too_stiff();
  body.integrator = Integrator::implicit;
  EXPECT_EQ(press(body).outcome, Outcome::stable);
}

// What the scenes of users have: the rule of contacts keeps them below the bound, whatever stiffness they ask for.
TEST(PressedBody, IsKeptStableByTheStabilityRule) {
  PressedBody body = too_stiff();
  body.stability_rule = true;
  EXPECT_EQ(press(body).outcome, Outcome::stable);
}

// The wall's own: seven times seven points, springs side by side, each damped by 2 zeta sqrt(k / lambda).
TEST(PressedBody, ShowsTheStiffnessOfItsContacts) {
  PressedBody body;
  const Response response = response_of(body);
  EXPECT_EQ(response.contacts, 49U);
  EXPECT_LE(std::abs(response.stiffness / (49 * body.stiffness) - 1), test::tolerance(1e-3));
  EXPECT_LE(std::abs(response.damping / (2 * body.damping_ratio * std::sqrt(49 * body.stiffness * body.mass)) - 1),
            test::tolerance(0.01));
}

}  // namespace
}  // namespace verisim::stability::pressed_body_test
