// The passivity controller: a contact gives no more energy than is available, and is otherwise unchanged
// (passive_scale).
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/random.hpp"
#include "engine/dynamics/integrator.hpp"
#include "tests/support/bodies.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::passive_contact_test {
namespace {

using test::brick;
using test::tolerance;

constexpr double kStep = 1e-3;

/// One of the two integrators, and a step of it with so much energy available [J].
struct Method {
  ContactWork (*contact_work)(const RigidBody&, const Loads&, double);
  StepWork (*step)(RigidBody&, const Loads&, double, double);
  StepWork within(double available, RigidBody& body, const Loads& loads) const {
    return step(body, loads, kStep, passive_scale(available, contact_work(body, loads, kStep)));
  }
};

/// A body that flies and turns against a contact somewhere on it, drawn from `r`: leaving or approaching, with a hand's
/// pull beside it.
struct Case {
  RigidBody body = brick(0.5, {0.1, 0.2, 0.3});
  Loads loads;
  explicit Case(const RandomStream& r, std::uint64_t i) {
    const auto vector = [&](std::uint64_t k, double size) {
      const std::uint64_t at = 64 * i + 3 * k;
      return Vector3d(size * r.normal(at), size * r.normal(at + 1), size * r.normal(at + 2));
    };
    body.v_C = vector(0, 0.1);
    body.omega = vector(1, 0.5);
    loads.external.force = vector(2, 5);
    const Vector3d arm = vector(3, 0.1);
    const Vector3d normal = vector(4, 1).normalized();
    const double k = 3000, depth = 2e-3;
    Vector6d J;
    J << normal, arm.cross(normal);
    loads.contact = {k * depth * J.head<3>(), k * depth * J.tail<3>()};
    loads.contact_stiffness = k * J * J.transpose();
    loads.contact_damping = 2 * J * J.transpose();
    if (i % 2 == 0) return;  // and every other one touches a body that moves, too
    loads.contact_mutual.force = vector(5, 3);
    loads.contact_mutual.torque = vector(6, 0.1).cross(loads.contact_mutual.force);
  }
};

class PassiveContact : public testing::TestWithParam<Method> {};

TEST_P(PassiveContact, GivesTheAvailableEnergyAndNoMore) {
  const RandomStream r(1, "passive contacts");
  int limited = 0;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const Case start(r, i);
    for (const double available : {0.0, 1e-6, 1e-4}) {
      Case free = start;
      const StepWork all = GetParam().step(free.body, free.loads, kStep, 1);
      Case tight = start;
      const StepWork work = GetParam().within(available, tight.body, tight.loads);
      EXPECT_LE(work.contact_work, available + tolerance(1e-16));
      if (all.contact_work <= available) continue;
      ++limited;
      EXPECT_GE(work.contact_work, available - tolerance(1e-16)) << "no less either";
      const double angle = work.contact.force.dot(all.contact.force);
      EXPECT_GE(angle, 0) << "it never pulls";
      EXPECT_LE(angle, all.contact.force.squaredNorm() * (1 + 1e-12));
    }
  }
  EXPECT_GT(limited, 500);
}

// Bit for bit: a contact that only resists, or gives less than is available, is unchanged.
TEST_P(PassiveContact, ChangesNothingBelowTheAvailableEnergy) {
  const RandomStream r(2, "passive contacts");
  int unlimited = 0;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Case free(r, i);
    Case tight = free;
    const StepWork all = GetParam().step(free.body, free.loads, kStep, 1);
    constexpr double kBudget = 1e-5;
    if (all.contact_work > kBudget) continue;
    ++unlimited;
    const StepWork work = GetParam().within(kBudget, tight.body, tight.loads);
    EXPECT_EQ(work.contact.force, all.contact.force);
    EXPECT_EQ(tight.body.v_C, free.body.v_C);
    EXPECT_EQ(tight.body.omega, free.body.omega);
    EXPECT_EQ(work.contact_work, all.contact_work);
  }
  EXPECT_GT(unlimited, 200);
}

// A body at rest that finds itself in a wall and is pushed into it: the wall holds it and does not throw it out.
TEST_P(PassiveContact, WithoutEnergyHoldsABodyAtRest) {
  RigidBody body = brick(0.5, {0.1, 0.1, 0.1});
  Loads loads;
  loads.external.force = {0, 0, -2};
  loads.contact.force = {0, 0, 10};
  loads.contact_stiffness(2, 2) = 5000;
  const StepWork work = GetParam().within(0, body, loads);
  EXPECT_LE(std::abs(work.contact.force.z() - 2), tolerance(1e-12));
  EXPECT_LE(std::abs(body.v_C.z()), tolerance(1e-15));
}

// A hand that pulls a body out of a wall feels nothing of the wall, if no energy is available.
TEST_P(PassiveContact, DoesNotHoldBackWhatLeaves) {
  RigidBody body = brick(0.5, {0.1, 0.1, 0.1});
  Loads loads;
  loads.external.force = {0, 0, 3};
  loads.contact.force = {0, 0, 10};
  loads.contact_stiffness(2, 2) = 5000;
  const StepWork work = GetParam().within(0, body, loads);
  EXPECT_EQ(work.contact.force.z(), 0);
  EXPECT_LE(std::abs(body.v_C.z() - 6 * kStep), tolerance(1e-15));
}

// The work predicted for a scale is that of the step, for any scale.
TEST_P(PassiveContact, PredictsTheWorkOfEveryScale) {
  const RandomStream r(3, "passive contacts");
  for (std::uint64_t i = 0; i < 300; ++i) {
    const Case start(r, i);
    const ContactWork told = GetParam().contact_work(start.body, start.loads, kStep);
    for (const double scale : {0.0, 0.25, 1.0}) {
      Case c = start;
      EXPECT_LE(std::abs(GetParam().step(c.body, c.loads, kStep, scale).contact_work - told.at(scale)),
                tolerance(1e-15));
    }
  }
}

// The wrench of two contacts divides into the wrenches of each.
TEST_P(PassiveContact, DividesIntoItsParts) {
  const RandomStream r(4, "passive contacts");
  for (std::uint64_t i = 0; i < 300; ++i) {
    Case c(r, i);
    const Case one = c;
    const Case other(r, 1000 + i);
    c.loads.contact += other.loads.contact;
    c.loads.contact_stiffness += other.loads.contact_stiffness;
    c.loads.contact_damping += other.loads.contact_damping;
    c.loads.contact_mutual += other.loads.contact_mutual;
    const StepWork work = GetParam().step(c.body, c.loads, kStep, i % 2 == 0 ? 1 : 0.3);
    Wrench sum;
    for (const Loads* part : {&one.loads, &other.loads}) {
      const double mutual = work.contact_end.mutual_scale;
      sum += {mutual * part->contact_mutual.force, mutual * part->contact_mutual.torque};
      sum += wrench_at_end(part->contact, part->contact_stiffness, part->contact_damping, part->contact_drift,
                           work.contact_end, kStep);
    }
    EXPECT_LE((sum.force - work.contact.force).norm(), tolerance(1e-12));
    EXPECT_LE((sum.torque - work.contact.torque).norm(), tolerance(1e-12));
  }
}

INSTANTIATE_TEST_SUITE_P(BothIntegrators, PassiveContact,
                         testing::Values(Method{contact_work_semi_implicit, step_semi_implicit},
                                         Method{contact_work_implicit, step_implicit}));

}  // namespace
}  // namespace verisim::passive_contact_test
