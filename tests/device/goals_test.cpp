// Hands that seek goals in the virtual world.
#include "tests/device/goals.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "engine/device/bubble.hpp"
#include "engine/device/filters.hpp"
#include "engine/device/hardware.hpp"
#include "tests/support/random_inputs.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::goals_test {
namespace {

using test::expect_refused;
using test::Inputs;
using test::reach_to;
using test::Seeking;
using test::tolerance;

HandDescription seeking(std::vector<HandGoal> goals) {
  HandDescription hand;
  hand.goals = std::move(goals);
  return hand;
}

/// A hand that is where its aim is.
HandDescription stiff(HandDescription hand) {
  hand.stiffness = 1e9;
  hand.damping = 0;
  hand.mass = 1e-6;
  hand.force_max = 1e9;
  return hand;
}

// Flash & Hogan 1985: x = d (10 s^3 - 15 s^4 + 6 s^5), v peaks at 1.875 d/T in the middle. T by Fitts' law: a tenth
// of a second for each bit, log2(2 d / W), W = 2 tolerance.
TEST(Goals, AMovementInTheFreeIsOneMinimumJerkOfFittsDuration) {
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u}) {
    SCOPED_TRACE(seed);
    Inputs inputs(seed);
    const Vector3d to = inputs.vector(0.3);
    HandDescription hand = stiff(seeking({reach_to(to)}));
    hand.reaction = 0.25;
    Seeking life(hand);
    life.seconds(3);
    const double d = to.norm(), T = std::max(0.1, 0.1 * std::log2(d / 0.005));
    double peak = 0, onset = -1, worst = 0;
    for (std::size_t i = 1; i < life.own.size(); ++i) {
      const double moved = (life.own[i].position - life.own[i - 1].position).norm();
      peak = std::max(peak, moved / life.dt);
      if (onset < 0 && moved > 1e-9) onset = static_cast<double>(i) * life.dt;
    }
    EXPECT_NEAR(peak, 1.875 * d / T, 1.875 * d / T * 1e-3);
    // The goal is in view in frame 0, seen in frame 1, known 0.25 s later; the first step is of the third order.
    EXPECT_NEAR(onset, 0.251, 0.004);
    for (std::size_t i = 0; i < life.own.size(); ++i) {
      const double s = std::clamp((static_cast<double>(i) * life.dt - 0.251) / T, 0.0, 1.0);
      worst = std::max(worst, (life.own[i].position - s * s * s * (10 - s * (15 - 6 * s)) * to).norm());
    }
    EXPECT_LT(worst, 0.02 * d * life.dt / T * 1000) << "off the closed form";
  }
}

// Behind any chain of scale, rotation and translation the handle arrives where it is wanted, turned as it is wanted.
TEST(Goals, AreReachedThroughScaleRotationAndTranslation) {
  for (const std::uint64_t seed : test::seeds(20)) {
    SCOPED_TRACE(seed);
    Inputs inputs(seed);
    const double scale = std::exp(inputs.between(-1, 3));
    const Quaterniond rotation = inputs.rotation();
    const Vector3d translation = inputs.vector(1);
    const Vector3d within = inputs.vector(0.15);
    HandGoal goal = reach_to(rotation * Vector3d(scale * within + translation));
    goal.to.rotation = inputs.rotation();
    goal.turns = true;
    goal.tolerance = 0.005 * scale;
    HandDescription hand = seeking({goal});
    hand.seed = seed;
    hand.tremor = 0.0003;
    Seeking life(hand, [&](std::shared_ptr<Device> device) {
      return make_rotate(make_translate(make_scale(std::move(device), scale), translation), rotation);
    });
    life.seconds(5);
    EXPECT_GT(life.time_of("has reached its goal"), 0.3);
    EXPECT_LE((life.seen.back().position - goal.to.position).norm(), goal.tolerance * 1.3);
    EXPECT_LE(vector_from_rotation(life.seen.back().rotation * goal.to.rotation.conjugate()).norm(), 0.06);
    EXPECT_LT(life.time_of("has reached its goal"), 3);
  }
}

/// The greatest force of the muscles, told by the motion of the hand alone: m a less what it felt.
double muscles_most(const Seeking& life, double mass) {
  double most = 0;
  for (std::size_t i = 2; i < life.own.size(); ++i) {
    const Vector3d a =
        (life.own[i].position - 2 * life.own[i - 1].position + life.own[i - 2].position) / (life.dt * life.dt);
    most = std::max(most, (mass * a - life.felt[i - 1].force).norm());
  }
  return most;
}

// In a bubble the goal lies far beyond what the hand can reach. Whatever the law, the handle comes there and stays, and
// the muscles never do more than they can.
TEST(Goals, AreReachedThroughABubbleWithEveryLaw) {
  for (const BubbleLawKind law : {BubbleLawKind::linear, BubbleLawKind::quadratic, BubbleLawKind::cubic,
                                  BubbleLawKind::peak_ring, BubbleLawKind::peak_ring_as_printed})
    for (const std::uint64_t seed : test::seeds(10)) {
      SCOPED_TRACE(testing::Message() << kBubbleLawNames[static_cast<std::size_t>(law)] << ", seed " << seed);
      Inputs inputs(seed);
      const Vector3d to = inputs.between(2, 4) * inputs.vector(1).normalized();
      HandGoal goal = reach_to(to);
      goal.tolerance = 0.02;
      HandDescription hand = seeking({goal});
      hand.seed = seed;
      hand.tremor = 0.0002;
      hand.force_max = 8;
      BubbleDescription bubble;
      bubble.law.kind = law;
      bubble.radius = inputs.between(0.2, 0.6);
      const bool ring = law == BubbleLawKind::peak_ring || law == BubbleLawKind::peak_ring_as_printed;
      bubble.law.scale = (ring ? 1.5 : 7) * inputs.between(0.5, 2);
      const double scale = inputs.between(2, 20);
      Seeking life(hand, [&](std::shared_ptr<Device> device) {
        return make_bubble(make_scale(std::move(device), scale), bubble);
      });
      life.seconds(30);
      EXPECT_GT(life.time_of("has reached its goal"), 1);
      EXPECT_LE((life.seen.back().position - to).norm(), 2 * goal.tolerance);
      EXPECT_LE(muscles_most(life, hand.mass), 8 * (1 + tolerance(1e-6)));
    }
}

}  // namespace
}  // namespace verisim::goals_test
