// Hands that seek goals in the virtual world.
#include "tests/device/goals.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "engine/device/bubble.hpp"
#include "engine/device/filters.hpp"
#include "engine/device/hardware.hpp"
#include "tests/length.hpp"
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
    for (const std::uint64_t seed : test::seeds(test::by_length<std::uint64_t>(2, 10, 10))) {
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

/// What a wall at x = 0.1 does to a handle: 20 kN/m.
Wrench wall(const DeviceReading& reading) {
  const double depth = reading.handle.position.x() - 0.1;
  return depth > 0 ? Wrench{{-20000 * depth, 0, 0}, {0, 0, 0}} : Wrench{};
}

// The goal is behind a wall. The hand pushes as hard as it can, no harder, and no faster than it pushes; then gives up.
TEST(Goals, BehindAWallAreGivenUpAfterPushing) {
  for (const double force : {1.5, 5.0, 12.0}) {
    SCOPED_TRACE(force);
    HandGoal goal = reach_to({0.3, 0, 0});
    goal.give_up = 8;
    HandDescription hand = seeking({goal});
    hand.force_max = force;
    Seeking life(hand);
    life.world = wall;
    life.seconds(10);
    EXPECT_NEAR(life.time_of("gives up reaching"), 8.2, 0.01);
    EXPECT_EQ(life.time_of("has reached"), -1);
    EXPECT_LE(muscles_most(life, hand.mass), force * (1 + tolerance(1e-6)));
    double most = 0;
    for (std::size_t i = 7000; i < 8200; ++i) most = std::max(most, life.felt[i].force.norm());
    EXPECT_NEAR(most, force, 0.02 * force) << "it pushes with all it has";
    // It goes no further than it came when it was told to give up.
    EXPECT_LE(life.felt.back().force.norm(), force * (1 + tolerance(1e-6)));
  }
}

// The faster it pushes the sooner the force is there: 10 N/s by default.
TEST(Goals, TheForceRisesAsFastAsTheHandPushes) {
  for (const double push : {5.0, 10.0, 20.0}) {
    SCOPED_TRACE(push);
    HandDescription hand = seeking({reach_to({0.3, 0, 0})});
    hand.push = push;
    hand.force_max = 15;
    Seeking life(hand);
    life.world = wall;
    life.seconds(6);
    // From the last time below 5 N to the first above 12 N.
    double at_5 = -1, at_12 = -1;
    for (std::size_t i = 0; i < life.felt.size() && at_12 < 0; ++i) {
      const double force = life.felt[i].force.norm(), t = static_cast<double>(i) * life.dt;
      if (t < 1.65) continue;  // the blow
      if (force < 5) at_5 = t;
      if (force > 12) at_12 = t;
    }
    ASSERT_GT(at_5, 1.65) << "it pushed at once";
    EXPECT_NEAR(at_12 - at_5, 7 / push, 0.15);
  }
}

TEST(Goals, ATouchIsFeltAReactionTimeLateAndRetreatedFrom) {
  for (const double reaction : {0.1, 0.3}) {
    SCOPED_TRACE(reaction);
    HandGoal goal = reach_to({0.3, 0, 0});
    goal.kind = GoalKind::touch;
    goal.force = 1.5;
    goal.retreat = {-0.1, 0.05, 0};
    HandDescription hand = seeking({goal});
    hand.reaction = reaction;
    Seeking life(hand);
    life.world = wall;
    life.seconds(5);
    EXPECT_GT(life.time_of("has touched and retreated"), 0);
    EXPECT_LE((life.seen.back().position - goal.retreat).norm(), goal.tolerance * 1.1);
    double touched = -1, back = -1;  // first so hard; last at all: in between it rebounds
    for (std::size_t i = 0; i < life.felt.size(); ++i) {
      const double force = life.felt[i].force.norm(), t = static_cast<double>(i) * life.dt;
      if (touched < 0 && force >= goal.force) touched = t;
      if (force > 0) back = t;
    }
    ASSERT_GT(touched, 0);
    EXPECT_GE(back, touched + reaction);
    EXPECT_LE(back, touched + reaction + 0.5);
  }
}

TEST(Goals, AreSoughtOneAfterTheOther) {
  HandGoal insert = reach_to({0.1, 0.1, -0.1}), withdraw = reach_to({0.1, 0.1, 0.1});
  insert.kind = GoalKind::insert;
  insert.from = Vector3d(0.1, 0.1, 0.1);
  withdraw.kind = GoalKind::withdraw;
  HandGoal first = reach_to({-0.1, 0, 0});
  first.dwell = 1;
  HandDescription hand = seeking({first, insert, withdraw});
  hand.repeat = true;
  Seeking life(hand);
  life.seconds(12);
  double last = 0;
  for (const char* what : {"begins to reach", "has reached its goal", "begins to insert", "has inserted",
                           "begins to withdraw", "has withdrawn"}) {
    SCOPED_TRACE(what);
    EXPECT_GT(life.time_of(what), last);
    last = life.time_of(what);
  }
  EXPECT_GE(life.time_of("begins to insert"), life.time_of("has reached its goal") + 1);
  EXPECT_GT(life.time_of("begins to reach", 2), last) << "and again";
  // On its way down it was over the hole: no further beside it than its tolerance.
  const auto frame = [&](double t) { return static_cast<std::size_t>(std::lround(t / life.dt)); };
  bool was_before_the_hole = false;
  for (std::size_t i = frame(life.time_of("begins to insert")); i < frame(life.time_of("has inserted")); ++i) {
    if (life.own[i].position.z() > 0.094) was_before_the_hole = true;
    if (was_before_the_hole && life.own[i].position.z() < 0.09) {
      ASSERT_LE((life.own[i].position - Vector3d(0.1, 0.1, 0)).head<2>().norm(), 1.2 * insert.tolerance) << i;
    }
  }
  EXPECT_TRUE(was_before_the_hole);
}

TEST(Goals, AWandererVisitsPlacesOfItsSeedInItsBox) {
  const auto places = [](std::uint64_t seed) {
    HandGoal goal;
    goal.kind = GoalKind::wander;
    goal.box_min = {-0.1, 0, 0.05};
    goal.box_max = {0.1, 0.2, 0.1};
    goal.places = 5;
    goal.dwell = 0.5;
    HandDescription hand = seeking({goal});
    hand.seed = seed;
    Seeking life(hand);
    life.seconds(15);
    EXPECT_GT(life.time_of("has wandered"), 3);
    for (std::size_t i = 2000; i < life.seen.size(); ++i) {
      EXPECT_GE((life.seen[i].position - goal.box_min).minCoeff(), -goal.tolerance);
      EXPECT_GE((goal.box_max - life.seen[i].position).minCoeff(), -goal.tolerance);
    }
    return life.seen[5000].position;
  };
  EXPECT_EQ(places(1), places(1));
  EXPECT_NE(places(1), places(2));
}

// A handle that is where the goal is while the body that it holds is not: who watches the body goes on.
TEST(Goals, OfTheBodyAreSoughtByTheBody) {
  for (const Watched watched : {Watched::handle, Watched::body}) {
    HandDescription hand = seeking({reach_to({0.1, 0, 0})});
    hand.watched = watched;
    const auto device = make_hand(hand);
    for (std::uint64_t i = 0; i < 3000; ++i) {
      DeviceFrame now{i, static_cast<double>(i) * 1e-3, 1e-3, 0, false, {}};
      now.sight = {device->reading().handle, device->reading().handle, true};
      now.sight.body.position += Vector3d(0, 0.05, 0);
      device->sample(now);
      device->render({}, now);
    }
    EXPECT_NEAR(device->reading().handle.position.y(), watched == Watched::body ? -0.05 : 0, 0.0026);
  }
}

TEST(Goals, OutsideOfTheDevicesWorkspaceAreSaidToBe) {
  for (const double x : {0.3, 0.4}) {  // an Omni reaches 0.08 m; scaled by 4, 0.32 m
    Seeking life(seeking({reach_to({x, 0, 0})}), [](std::shared_ptr<Device> device) {
      return make_scale(make_hardware(phantom_omni("omni"), std::move(device)), 4);
    });
    life.seconds(1);
    EXPECT_EQ(life.time_of("outside of its device's workspace") > 0, x > 0.32) << x;
  }
}

// Pitch / 2 from each place within its radius: drawn from where the hand went, not from how it was told to go.
TEST(PegSearch, ASpiralLeavesNoGapWiderThanItsPitch) {
  HandGoal goal = reach_to({0, 0, -0.3});
  goal.kind = GoalKind::insert;
  goal.strategy = PegStrategy::spiral;
  goal.pitch = 0.004;
  goal.search_radius = 0.015;
  goal.give_up = 100;
  HandDescription hand = seeking({goal});
  Seeking life(hand);
  life.world = [](const DeviceReading& reading) {  // a floor at z = -0.05
    const double depth = -0.05 - reading.handle.position.z();
    return depth > 0 ? Wrench{{0, 0, 20000 * depth}, {0, 0, 0}} : Wrench{};
  };
  life.seconds(14);
  Inputs inputs(1);
  for (int i = 0; i < 300; ++i) {
    Vector3d place = 0.013 * inputs.vector(1);
    place.z() = 0;
    if (place.norm() > 0.013) continue;
    double nearest = 1;
    for (const Pose& pose : life.seen)
      if (pose.position.z() < -0.0499) nearest = std::min(nearest, (pose.position - place).head<2>().norm());
    EXPECT_LE(nearest, 0.5 * goal.pitch * 1.15) << place.transpose();
  }
}

TEST(Persons, AreAnotherForEachSeedWithinTheirRange) {
  // A mass is told by how far a push of one frame moves a hand without spring and damper: they are its own here.
  std::vector<Vector3d> ends;
  for (const std::uint64_t seed : test::seeds(30)) {
    HandDescription hand = seeking({reach_to({0, 0, 0})});
    hand.arm = ArmKind::drawn;
    hand.seed = seed;
    hand.tremor = 1e-12;
    Seeking life(hand);
    life.world = [](const DeviceReading&) { return Wrench{{0, 0.5, 0}, {0, 0, 0}}; };
    life.seconds(0.19);  // before it knows
    ends.push_back(life.own.back().position);
    // At rest 0.5 N move 135 N/m, halved to doubled, by 1.85 to 7.4 mm; in 0.19 s at most that and an overshoot.
    EXPECT_GT(ends.back().y(), 0.0005);
    EXPECT_LT(ends.back().y(), 0.015);
  }
  for (std::size_t i = 1; i < ends.size(); ++i) EXPECT_NE(ends[i], ends[0]);
}

TEST(Goals, RefuseADescriptionThatIsNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  const auto with = [](auto change) {
    return [change] {
      HandDescription hand = seeking({reach_to({0.1, 0, 0})});
      hand.name = "right";
      change(hand);
      return make_hand(hand);
    };
  };
  expect_refused(with([](auto& h) { h.path.push_back({}); }), "both a path and goals");
  expect_refused(with([](auto& h) { h.goals.clear(); }), "path has no waypoints");
  expect_refused(with([=](auto& h) { h.goals[0].to.position.x() = nan; }), "place is not finite");
  expect_refused(with([](auto& h) { h.goals[0].to.rotation.coeffs().setZero(); }), "unit quaternion");
  expect_refused(with([=](auto& h) { h.goals[0].from = Vector3d(nan, 0, 0); }), "from is not finite");
  expect_refused(with([=](auto& h) { h.goals[0].retreat.y() = infinity; }), "retreat is not finite");
  expect_refused(with([=](auto& h) { h.goals[0].box_max.y() = infinity; }), "box is not finite");
  expect_refused(with([](auto& h) { h.goals[0].box_min.y() = 1; }), "box ends before it begins");
  expect_refused(with([](auto& h) { h.start.rotation.coeffs().setZero(); }), "start is not finite");
  for (const double bad : {0.0, -1.0, nan, infinity}) {
    expect_refused(with([=](auto& h) { h.goals[0].tolerance = bad; }), "tolerance");
    expect_refused(with([=](auto& h) { h.goals[0].angular_tolerance = bad; }), "angularTolerance");
    expect_refused(with([=](auto& h) { h.goals[0].force = bad; }), "force");
    expect_refused(with([=](auto& h) { h.goals[0].give_up = bad; }), "giveUp");
    expect_refused(with([=](auto& h) { h.goals[0].pitch = bad; }), "pitch");
    expect_refused(with([=](auto& h) { h.goals[0].search_speed = bad; }), "searchSpeed");
    expect_refused(with([=](auto& h) { h.goals[0].search_radius = bad; }), "searchRadius");
    expect_refused(with([=](auto& h) { h.goals[0].tilt = bad; }), "tilt");
    expect_refused(with([=](auto& h) { h.goals[0].press = bad; }), "press");
    expect_refused(with([=](auto& h) { h.reach = bad; }), "reach");
    expect_refused(with([=](auto& h) { h.push = bad; }), "push");
    expect_refused(with([=](auto& h) { h.force_max = bad; }), "greatest force");
    expect_refused(with([=](auto& h) { h.stiffness = bad; }), "stiffness");
  }
  for (const double bad : {-1.0, nan, infinity}) {
    expect_refused(with([=](auto& h) { h.goals[0].dwell = bad; }), "dwell");
    expect_refused(with([=](auto& h) { h.goals[0].tip = bad; }), "tip");
    expect_refused(with([=](auto& h) { h.reaction = bad; }), "reaction");
  }
  for (const double bad : {0.0, -1.0, nan}) expect_refused(with([=](auto& h) { h.goals[0].speed = bad; }), "speed");
  // More frames of what was seen than are kept.
  const auto hand = make_hand(seeking({reach_to({0.1, 0, 0})}));
  expect_refused([&] { hand->sample({0, 0, 1e-6, 0, false, {}}); }, "a reaction time of 0.2 s");
}

}  // namespace
}  // namespace verisim::goals_test
