#include "engine/contact/grip.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/base/random.hpp"

namespace verisim::grip_test {
namespace {

constexpr double kStep = 1e-3;
constexpr double kMass = 0.1;  // kg
constexpr double kPress = 2;   // N, along z
constexpr double kLimit = Grip::kGrip * kPress;

/// A body of 0.1 kg, like a ball of 3 cm, that presses with 2 N on a place 3 cm below its centre of mass.
struct Pressed {
  Grip grip;
  Twist velocity;
  Vector3d arm = {0, 0, -0.03};
  double patch_radius = 0.002;
  Grip::Matrices last;

  /// What the grip does while the body moves on with its velocity.
  Wrench step() {
    Grip::Patch patch{arm, patch_radius, kStep * (velocity.linear + velocity.angular.cross(arm)),
                      kStep * velocity.angular};
    grip.follow(patch);
    Matrix6d mobility = Matrix6d::Zero();
    mobility.topLeftCorner<3, 3>().diagonal().setConstant(1 / kMass);
    mobility.bottomRightCorner<3, 3>().diagonal().setConstant(1 / (0.4 * kMass * 0.03 * 0.03));
    Wrench wrench{{0, 0, kPress}, Vector3d::Zero()};
    last = grip.hold({arm, patch.radius, velocity, mobility, 4, kStep}, wrench);
    wrench.force.z() -= kPress;
    return wrench;
  }
  /// As step(), and the body gets faster by that and by a push, as by a semi-implicit step.
  void free_step(const Vector3d& push) {
    const Wrench w = step();
    velocity.linear += kStep / kMass * (w.force + push);
    velocity.angular += kStep / (0.4 * kMass * 0.03 * 0.03) * (w.torque);
  }
};

TEST(Grip, HoldsWhatIsPushedByLessThanItsLimit) {
  Pressed body;
  Vector3d way = Vector3d::Zero();
  for (int i = 0; i < 20000; ++i) {
    body.free_step({0.3 * kLimit, -0.2 * kLimit, 0});
    way += kStep * body.velocity.linear;
  }
  EXPECT_LE(body.velocity.linear.norm(), 1e-12);
  EXPECT_LE(body.velocity.angular.norm(), 1e-10);
  EXPECT_LE(way.norm(), 1e-4) << "it stretches";
}

TEST(Grip, SlipsWhereMoreThanItsLimitPushes) {
  Pressed body;
  for (int i = 0; i < 1000; ++i) body.free_step({3 * kLimit, 0, 0});
  EXPECT_GE(body.velocity.linear.x(), 0.01);
  EXPECT_EQ(body.last.stiffness, 0);
  EXPECT_EQ(body.last.across, Matrix6d::Zero());
}

TEST(Grip, StopsASpinAndARoll) {
  for (const Vector3d axis : {Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()}) {
    Pressed body;
    body.velocity.angular = 0.1 * axis;
    for (int i = 0; i < 20000; ++i) body.free_step(Vector3d::Zero());
    EXPECT_LE(body.velocity.angular.norm(), 1e-9) << axis.transpose();
  }
}

TEST(Grip, FadesForWhatMovesOnPurpose) {
  for (const double speed : {0.1, 1.0}) {
    Pressed body;
    body.velocity.linear.x() = speed;
    double drag = 0;
    for (int i = 0; i < 100; ++i) drag = body.step().force.norm();
    EXPECT_LE(drag, 1.01 * kLimit * Grip::kFast * Grip::kFast / (speed * speed));
    EXPECT_GT(drag, 0);
  }
}

TEST(Grip, NeverDoesMoreThanItsLimitAndNothingAlongThePressure) {
  const RandomStream r(5, "grip");
  Pressed body;
  for (std::uint64_t i = 0; i < 5000; ++i) {
    const auto draw = [&](std::uint64_t k) { return 2 * r.uniform(8 * i + k) - 1; };
    body.velocity = {0.01 * Vector3d(draw(0), draw(1), draw(2)), Vector3d(draw(3), draw(4), draw(5))};
    const Wrench w = body.step();
    EXPECT_LE(w.force.norm(), kLimit * (1 + 1e-12));
    EXPECT_LE(std::abs(w.force.z()), 1e-15);
  }
}

// What goes round and comes back to where it began has given energy, not taken any.
TEST(Grip, GivesNoEnergy) {
  const RandomStream r(6, "grip");
  for (std::uint64_t run = 0; run < 50; ++run) {
    Pressed body;
    double work = 0;
    for (std::uint64_t i = 0; i < 2000; ++i) {
      const double t = 2 * std::numbers::pi * static_cast<double>(i) / 2000;
      const auto wave = [&](std::uint64_t k) {
        return r.uniform(32 * run + k) * std::cos(t * (1 + static_cast<double>(k)) + 6 * r.uniform(32 * run + 8 + k));
      };
      const Twist before = body.velocity;
      body.velocity = {0.005 * Vector3d(wave(0), wave(1), 0), 0.1 * Vector3d(wave(2), wave(3), wave(4))};
      const Wrench w = body.step();
      const Vector3d moved = 0.5 * kStep * (before.linear + body.velocity.linear);
      const Vector3d turned = 0.5 * kStep * (before.angular + body.velocity.angular);
      work += w.force.dot(moved) + w.torque.dot(turned);
    }
    EXPECT_LT(work, 0) << run;
  }
}

TEST(Grip, HoldsAPlaceAtTheCentreOfMass) {
  Pressed body;
  body.arm.setZero();
  body.patch_radius = 0;
  body.velocity = {{0.001, 0, 0}, {0, 0, 0.1}};
  for (int i = 0; i < 3; ++i) EXPECT_LT(body.step().force.x(), 0) << "a number, and against the motion";
}

TEST(Grip, HasNothingToHoldWithoutPressure) {
  Grip grip;
  grip.follow({Vector3d::Zero(), 0.01, Vector3d(0.001, 0, 0), Vector3d::Zero()});
  Wrench nothing;
  const Grip::Matrices held =
      grip.hold({Vector3d::Zero(), 0.01, {{1, 0, 0}, Vector3d::Zero()}, Matrix6d::Identity(), 4, kStep}, nothing);
  EXPECT_EQ(nothing.force, Vector3d::Zero());
  EXPECT_EQ(held.stiffness, 0);
}

}  // namespace
}  // namespace verisim::grip_test
