// Hands that touch and retreat: what tells them that they have touched.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/device/goals.hpp"
#include "tests/support/random_inputs.hpp"
#include "tests/support/refusal.hpp"

namespace verisim::touch_test {
namespace {

using test::expect_refused;
using test::Inputs;
using test::seeds;
using test::Seeking;

/// Believes that there is something 0.2 m away along x.
HandDescription toucher() {
  HandGoal goal;
  goal.kind = GoalKind::touch;
  goal.to.position = {0.2, 0, 0};
  goal.retreat = {-0.05, 0, 0};
  goal.force = 1e9;
  goal.give_up = 8;
  HandDescription hand;
  hand.goals = {goal};
  return hand;
}

/// A wall of 20000 N/m that begins at x.
Seeking::World wall_at(double x) {
  return [x](const DeviceReading& reading) {
    return Wrench{{-20000 * std::max(0.0, reading.handle.position.x() - x), 0, 0}, Vector3d::Zero()};
  };
}

double first_beyond(const Seeking& life, double x) {
  for (std::size_t i = 0; i < life.own.size(); ++i)
    if (life.own[i].position.x() > x) return static_cast<double>(i) * life.dt;
  return -1;
}

// The wall stands nearer than it believes. It turns when it has seen the handle stand for `stall`, a reaction time
// late.
TEST(Touch, IsSeenInWhatStandsStill) {
  for (const std::uint64_t seed : seeds(20)) {
    SCOPED_TRACE(seed);
    Inputs inputs(seed);
    HandDescription hand = toucher();
    const double wall = inputs.between(0.05, 0.17), stall = inputs.between(0.2, 1);
    hand.goals[0].stall = stall;
    hand.reaction = inputs.between(0.1, 0.3);
    Seeking life(hand);
    life.world = wall_at(wall);
    life.seconds(4);
    const double touched = first_beyond(life, wall);
    ASSERT_GT(touched, 0);
    double turned = -1;
    for (std::size_t i = 0; i < life.own.size() && turned < 0; ++i)
      if (static_cast<double>(i) * life.dt > touched && life.own[i].position.x() < wall - 0.004)
        turned = static_cast<double>(i) * life.dt;
    // It may bounce off and settle for a while; and its muscles need some time to come back.
    EXPECT_GT(turned, touched + stall + *hand.reaction - 0.01);
    EXPECT_LT(turned, touched + stall + *hand.reaction + 0.6);
    EXPECT_GT(life.time_of("touched"), 0);
  }
}

TEST(Touch, IsNotSeenFarFromWhereItIsExpectedNorWithoutStall) {
  for (const bool stalls : {true, false}) {
    HandDescription hand = toucher();
    if (stalls) hand.goals[0].stall = 0.3;
    hand.goals[0].near = 0.05;
    Seeking life(hand);
    life.world = wall_at(0.1);
    life.seconds(5);
    EXPECT_GT(life.own.back().position.x(), 0.09) << "it pushes on";
    EXPECT_LT(life.time_of("touched"), 0);
  }
}

// What goes to and fro is where it was half a second ago, but it does not stand.
TEST(Touch, IsNotSeenInWhatTurnsRound) {
  HandDescription hand = toucher();
  hand.goals[0].stall = 0.5;
  hand.goals[0].to.position.x() = 0.4;  // it does not come so far
  Seeking life(hand);
  life.world = [&](const DeviceReading&) {  // pushed to and fro, 1 Hz
    return Wrench{{-30 * std::sin(2 * 3.14159265 * static_cast<double>(life.frame) * life.dt), 0, 0}, Vector3d::Zero()};
  };
  life.seconds(3);
  EXPECT_LT(life.time_of("touched"), 0);
}

TEST(Touch, RefusesAStallThatNobodyRemembers) {
  HandDescription hand = toucher();
  hand.goals[0].stall = 10;
  Seeking life(hand);
  expect_refused([&] { life.step(); }, "a stall of 10 s");
}

}  // namespace
}  // namespace verisim::touch_test
