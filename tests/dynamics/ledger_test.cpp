// The ledger's equation, kinetic + coupling + gravity + dissipated + contact + numerical = input + start, for
// everything that may act on a body.
#include "engine/dynamics/ledger.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/bodies.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::ledger_test {
namespace {

using test::brick;
using test::tolerance;

using Step = StepWork (*)(RigidBody&, const Loads&, double, double);

struct World {
  bool gravity = false, held = false, wall = false;
  double spin = 0;     ///< rad/s
  bool slips = false;  ///< the coupling is limited to a fraction of what the hand pulls with
};

/// The result of one second of that world.
struct Outcome {
  double residual = 0;   ///< largest ever
  double turnover = 0;   ///< the energies that went through, to judge the residual against
  double numerical = 0;  ///< at the end
  double dissipated = 0, contact = 0;
  double pull = 0;  ///< largest force of the coupling
};

Loads loads_of(const World& world, const RigidBody& body, const Coupling& coupling, const CouplingTarget& target) {
  Loads loads;
  if (world.gravity) loads.external.force = {0, 0, -9.81 * body.mass};
  if (world.held) {
    loads.coupling = &coupling;
    loads.target = target;
    loads.coupling_at_start = coupling_force(coupling, body, target);
  }
  const Vector3d arm = body.R_WB * Vector3d(0.05, 0.02, -0.1);  // a foot that is not below the centre
  const double depth = -(body.p_WC + arm).z() - 0.1;
  if (!world.wall || depth <= 0) return loads;
  const double k = 2000, b = 5;
  Vector6d J, u;
  J << Vector3d::UnitZ(), arm.cross(Vector3d::UnitZ());
  u << body.v_C, body.omega;
  const double force = std::max(0.0, k * depth - b * J.dot(u));
  loads.contact = {force * J.head<3>(), force * J.tail<3>()};
  loads.contact_stiffness = k * J * J.transpose();
  loads.contact_damping = b * J * J.transpose();
  return loads;
}

/// As the step keeps it: `shadow_dt` is the step of a velocity-first integrator, else 0.
EnergyState energy_of(const World& world, const RigidBody& body, const Coupling& coupling, const CouplingTarget& target,
                      double shadow_dt) {
  EnergyState e{body.kinetic_energy(), 0, 0};
  if (world.held) {
    const CouplingForce pull = coupling_force(coupling, body, target);
    e.coupling = coupling_energy(coupling, pull) + shadow_energy(pull.spring, body, shadow_dt);
  }
  if (world.gravity) {
    const double weight = 9.81 * body.mass;
    e.gravity = weight * body.p_WC.z() + shadow_energy({{0, 0, -weight}, Vector3d::Zero()}, body, shadow_dt);
  }
  return e;
}

Outcome live(const World& world, Step step, double dt) {
  RigidBody body = brick(0.5, {0.1, 0.2, 0.3});
  body.v_C = {0.3, -0.2, -0.4};
  body.omega = world.spin * Vector3d(0.5, 0.7, -0.5);
  CouplingLimits limits{300, 0.1};
  if (world.slips) limits.force_max = 2, limits.torque_max = 0.004;
  const Coupling coupling = make_coupling(body, 1e-3, limits, true);
  const auto handle = [&](double t) {  // a hand that draws a curve and turns
    CouplingTarget target;
    target.p_WC = {0.1 * std::sin(3 * t), 0.05 * std::cos(2 * t), -0.05 * std::sin(4 * t)};
    target.R_WB = rotation_from_vector({0.5 * std::sin(2 * t), 0.3 * t, 0});
    target.v_C = {0.3 * std::cos(3 * t), -0.1 * std::sin(2 * t), -0.2 * std::cos(4 * t)};
    target.omega = {std::cos(2 * t), 0.3, 0};
    return target;
  };
  Ledger ledger;
  const double shadow_dt = step == step_semi_implicit ? dt : 0;
  EnergyState energy = energy_of(world, body, coupling, handle(0), shadow_dt);
  ledger.start(energy);
  Outcome outcome;
  for (int i = 0; i < std::lround(1 / dt); ++i) {
    const CouplingTarget target = handle(i * dt);
    ledger.add_jump(energy_of(world, body, coupling, target, shadow_dt).sum() - energy.sum());
    const StepWork work = step(body, loads_of(world, body, coupling, target), dt, 1);
    ledger.add(work);
    outcome.pull = std::max(outcome.pull, work.coupling.force.norm());
    energy = energy_of(world, body, coupling, target, shadow_dt);
    outcome.residual = std::max(outcome.residual, std::abs(ledger.residual(energy)));
    outcome.turnover = std::max({outcome.turnover, energy.kinetic, energy.coupling, std::abs(energy.gravity)});
  }
  outcome.numerical = ledger.numerical();
  outcome.dissipated = ledger.dissipated();
  outcome.contact = ledger.contact();
  return outcome;
}

const std::vector<World> kWorlds = {{},
                                    {.spin = 20},
                                    {.gravity = true},
                                    {.held = true},
                                    {.gravity = true, .held = true, .spin = 5},
                                    {.gravity = true, .wall = true},
                                    {.gravity = true, .held = true, .wall = true, .spin = 5}};

class LedgerOf : public testing::TestWithParam<Step> {};

// A thousand steps, each adding some twenty roundings of the energies that are there.
TEST_P(LedgerOf, ClosesToRoundingWhateverActs) {
  for (std::size_t i = 0; i < kWorlds.size(); ++i) {
    SCOPED_TRACE(i);
    const Outcome o = live(kWorlds[i], GetParam(), 1e-3);
    ASSERT_GT(o.turnover, 0.01);
    EXPECT_LE(o.residual, tolerance(1000 * 20 * 0x1p-53 * o.turnover));
  }
}

TEST_P(LedgerOf, ClosesWhileTheClutchSlips) {
  const Outcome tight = live({.held = true, .spin = 5}, GetParam(), 1e-3);
  const Outcome slipping = live({.held = true, .spin = 5, .slips = true}, GetParam(), 1e-3);
  EXPECT_LE(slipping.residual, tolerance(1000 * 20 * 0x1p-53 * slipping.turnover));
  EXPECT_GT(tight.pull, 3) << "the limit would never be reached";
  EXPECT_LE(slipping.pull, 2 * (1 + 1e-3));
}

// First order: ten times smaller steps leave about a tenth; with room for impacts that fall otherwise between steps.
TEST_P(LedgerOf, NumericalPartShrinksWithTheStep) {
  for (std::size_t i = 1; i < kWorlds.size(); ++i) {
    SCOPED_TRACE(i);
    const double coarse = live(kWorlds[i], GetParam(), 1e-3).numerical;
    const double fine = live(kWorlds[i], GetParam(), 1e-4).numerical;
    EXPECT_LE(std::abs(fine), 0.2 * std::abs(coarse));
    EXPECT_GT(std::abs(coarse), 0);
  }
}

TEST_P(LedgerOf, DampersAndContactOnlyTake) {
  for (const World& world : kWorlds) {
    const Outcome o = live(world, GetParam(), 1e-4);
    EXPECT_GE(o.dissipated, 0);
    if (world.held) {
      EXPECT_GT(o.dissipated, 0);
    }
    if (!world.wall) continue;
    EXPECT_GT(o.contact, 0) << "the wall was never met or gave energy";
  }
}

INSTANTIATE_TEST_SUITE_P(BothIntegrators, LedgerOf, testing::Values(step_semi_implicit, step_implicit));

/// A linear oscillator without damping: what one step of each integrator loses is known.
struct OneStep {
  RigidBody body = brick(2, {0.1, 0.1, 0.1});
  Coupling spring;
  Loads loads;
  double v0 = 0.3, d0 = 0.01, k = 500, dt = 1e-2;
  OneStep() {
    spring.stiffness = k;
    body.v_C.x() = v0;
    body.p_WC.x() = -d0;
    loads.coupling = &spring;
    loads.target = {Vector3d::Zero(), Quaterniond::Identity(), Vector3d::Zero(), Vector3d::Zero()};
    loads.coupling_at_start = coupling_force(spring, body, loads.target);
  }
};

// Velocity first: m dv^2/2 lost at the mass, k dx^2/2 gained at the spring, which is taken where it was. Both together
// are the change of dt/2 f.u, which the next steps give back: the shadow energy stays, to rounding.
TEST(NumericalLoss, OfTheSemiImplicitStepIsNone) {
  OneStep s;
  const double v1 = s.v0 + s.dt * s.k * s.d0 / 2;
  const double lost = 0.5 * 2 * (v1 - s.v0) * (v1 - s.v0) - 0.5 * s.k * s.dt * s.dt * v1 * v1;
  const double lent = 0.5 * s.dt * s.k * ((s.d0 - s.dt * v1) * v1 - s.d0 * s.v0);
  EXPECT_GT(std::abs(lost), 1e-4);
  EXPECT_LE(std::abs(lost - lent), tolerance(16 * 0x1p-53));
  EXPECT_LE(std::abs(step_semi_implicit(s.body, s.loads, s.dt).numerical), tolerance(16 * 0x1p-53));
}

// A thousand periods: the energy itself swings by x^2/4, x = dt sqrt(k/m); the shadow energy is there to rounding.
TEST(ShadowEnergy, OfALinearOscillatorStaysForTwoHundredThousandSteps) {
  OneStep s;
  const auto energies = [&] {
    const CouplingForce pull = coupling_force(s.spring, s.body, s.loads.target);
    const double plain = s.body.kinetic_energy() + coupling_energy(s.spring, pull);
    return std::pair(plain, plain + shadow_energy(pull.spring, s.body, s.dt));
  };
  const auto [plain_start, start] = energies();
  double swing = 0;
  for (int i = 0; i < 200'000; ++i) {
    s.loads.coupling_at_start = coupling_force(s.spring, s.body, s.loads.target);
    (void)step_semi_implicit(s.body, s.loads, s.dt);
    const auto [plain, shadow] = energies();
    swing = std::max(swing, std::abs(plain - plain_start));
    ASSERT_LE(std::abs(shadow - start), tolerance(1e-9 * start)) << "step " << i;
  }
  EXPECT_GT(swing, 0.01 * start);
}

// Backward Euler loses at both: m dv^2/2 + k dx^2/2.
TEST(NumericalLoss, OfTheImplicitStepIsItsClosedForm) {
  OneStep s;
  const double v1 = (s.v0 + s.dt * s.k * s.d0 / 2) / (1 + s.dt * s.dt * s.k / 2);
  const double expected = 0.5 * 2 * (v1 - s.v0) * (v1 - s.v0) + 0.5 * s.k * s.dt * s.dt * v1 * v1;
  EXPECT_LE(std::abs(step_implicit(s.body, s.loads, s.dt).numerical - expected), tolerance(16 * 0x1p-53));
}

// Turning keeps L while I changes in the world: the energy that the turn loses is booked, not hidden.
TEST(NumericalLoss, OfAFreeSpinIsTheChangeOfKineticEnergy) {
  RigidBody body = brick(1, {0.1, 0.2, 0.3});
  body.omega = {10, 20, 5};
  const double before = body.kinetic_energy();
  const StepWork work = step_semi_implicit(body, {}, 1e-2);
  EXPECT_GT(std::abs(work.numerical), 1e-6);
  EXPECT_LE(std::abs(before - body.kinetic_energy() - work.numerical), tolerance(16 * 0x1p-53 * before));
}

TEST(Ledger, StartResetsIt) {
  Ledger ledger;
  ledger.add_jump(3);
  StepWork work;
  work.damper = 1;
  work.contact_work = -2;
  work.numerical = 4;
  ledger.add(work);
  EXPECT_EQ(ledger.contact(), 2);
  ledger.start({.kinetic = 1, .coupling = 2, .gravity = -4});
  EXPECT_EQ(ledger.input(), 0);
  EXPECT_EQ(ledger.numerical(), 0);
  EXPECT_EQ(ledger.residual({.kinetic = 1, .coupling = 2, .gravity = -4}), 0);
  EXPECT_EQ(ledger.residual({.kinetic = 2, .coupling = 2, .gravity = -4}), 1);
}

}  // namespace
}  // namespace verisim::ledger_test
