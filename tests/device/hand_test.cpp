#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "engine/base/pinned_math.hpp"
#include "engine/device/sources.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::hand_test {
namespace {

using pinned::kPi;
using test::expect_refused;
using test::tolerance;

constexpr double kStep = 1e-3;

Pose place(double x, double y = 0, double z = 0) {
  return {{x, y, z}, Quaterniond::Identity()};
}

/// A hand and the frames it has lived.
struct Living {
  std::shared_ptr<Device> device;
  std::uint64_t frame = 0;

  explicit Living(HandDescription description) : device(make_hand(std::move(description))) {}
  [[nodiscard]] const Pose& pose() const { return device->reading().handle; }
  void frames(int n, const Wrench& felt = {}) {
    for (int i = 0; i < n; ++i, ++frame) {
      device->sample({frame, static_cast<double>(frame) * kStep, kStep});
      device->render(felt, {frame, static_cast<double>(frame) * kStep, kStep});
    }
  }
  /// Frames until the hand is within `near` of x; -1 if that takes more than `most`. A wall at x = `wall` holds it up.
  int frames_to(double x, double near, int most, double wall = std::numeric_limits<double>::infinity()) {
    for (int i = 0; i < most; ++i) {
      const double depth = pose().position.x() - wall;
      frames(1, depth > 0 ? Wrench{{-5000 * depth, 0, 0}, {0, 0, 0}} : Wrench{});
      if (std::abs(pose().position.x() - x) <= near) return i;
    }
    return -1;
  }
};

HandDescription reaching(std::vector<HandWaypoint> path) {
  HandDescription hand;
  hand.path = std::move(path);
  return hand;
}

TEST(Hand, ReachesItsTargetInPlaceAndRotation) {
  const Pose goal{{0.1, -0.05, 0.2}, rotation_from_vector({0.5, 1, -0.5})};
  Living hand(reaching({{place(0)}, {goal, 0.2, 0}}));
  hand.frames(static_cast<int>(hand.device->duration() / kStep));
  // A second of settling at sqrt(k/m) = 52 rad/s and sqrt(kappa/I) = 45 rad/s: e^-45 (1 + 45) of what it lagged behind.
  EXPECT_LE((hand.pose().position - goal.position).norm(), tolerance(1e-12));
  EXPECT_LE(vector_from_rotation(hand.pose().rotation * goal.rotation.conjugate()).norm(), tolerance(1e-12));
}

// Behind a target at constant speed a mass with damper b to the world lags by b v / k.
TEST(Hand, LagsBehindItsTargetByDampingTimesSpeedOverStiffness) {
  Living hand(reaching({{place(0)}, {place(1), 0.1, 0}}));
  hand.frames(5001);  // 5000 steps, of which the first arrives at the first waypoint
  const double target = 4999 * kStep * 0.1;
  EXPECT_LE(std::abs(target - hand.pose().position.x() - 15.5 * 0.1 / 400), tolerance(1e-12));
}

// At rest the felt force balances the spring: F/k and torque/kappa.
TEST(Hand, GivesWayByForceOverStiffness) {
  Living hand(reaching({{place(0)}}));
  hand.frames(3000, {{2, 0, -4}, {0, 0.1, 0}});
  EXPECT_LE((hand.pose().position - Vector3d(0.005, 0, -0.01)).norm(), tolerance(1e-14));
  EXPECT_LE((vector_from_rotation(hand.pose().rotation) - Vector3d(0, 0.05, 0)).norm(), tolerance(1e-14));
}

// Held by something hard, a hand whose target may run 10 mm ahead pulls with 400 N/m times that; where it takes 0.2 s
// to know, the target has gone on with 0.1 m/s meanwhile.
TEST(Hand, NoticesAfterItsReactionTimeThatItIsHeldUp) {
  for (const double reaction : {0.0, 0.05, 0.2}) {
    HandDescription description = reaching({{place(0)}, {place(1), 0.1, 0}});
    description.lead = 0.01;
    description.reaction = reaction;
    const auto hand = make_hand(description);
    double pulls = 0;
    for (std::uint64_t frame = 0; frame < 1500; ++frame) {
      const DeviceFrame now{frame, static_cast<double>(frame) * kStep, kStep, 0, false};
      hand->sample(now);
      pulls = 1e5 * hand->reading().handle.position.x();
      hand->render({{-pulls, 0, 0}, Vector3d::Zero()}, now);
    }
    EXPECT_NEAR(pulls, 400 * (0.01 + 0.1 * reaction), 400 * 0.0003) << reaction;
  }
}

TEST(Hand, StaysFiniteAtAnyStiffnessMassAndStep) {
  for (const double stiffness : {0.0, 1.0, 1e12})
    for (const double mass : {1e-9, 0.15, 1e9})
      for (const double dt : {1e-6, 1.0}) {
        HandDescription description = reaching({{place(0)}, {place(0.1), 0.1, 0}});
        description.mass = description.inertia = mass;
        description.stiffness = description.angular_stiffness = stiffness;
        Living hand(description);
        for (std::uint64_t i = 0; i < 2000; ++i) {
          hand.device->sample({i, static_cast<double>(i) * dt, dt});
          hand.device->render({{3, -3, 3}, {0.1, 0, -0.1}}, {i, static_cast<double>(i) * dt, dt});
        }
        ASSERT_TRUE(hand.pose().position.allFinite());
        ASSERT_LE(std::abs(hand.pose().rotation.norm() - 1), tolerance(4 * 0x1p-53));
      }
}

/// Displacement of a hand that is so stiff and light that it follows its tremor: seconds * 1000 samples of one axis.
std::vector<double> tremble(double rms, std::uint64_t seed, int seconds) {
  HandDescription description = reaching({{place(0)}});
  description.tremor = rms;
  description.seed = seed;
  description.mass = 1e-9;
  description.damping = 0;
  Living hand(description);
  hand.frames(2);
  std::vector<double> x;
  for (int i = 0; i < seconds * 1000; ++i) {
    hand.frames(1);
    x.push_back(hand.pose().position.x());
  }
  return x;
}

/// Power of x at `hertz`, relative to that of a sine of the same rms.
double power_at(const std::vector<double>& x, double hertz) {
  double re = 0, im = 0, total = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double phase = 2 * kPi * hertz * static_cast<double>(i) * kStep;
    re += x[i] * std::cos(phase);
    im += x[i] * std::sin(phase);
    total += x[i] * x[i];
  }
  return 2 * (re * re + im * im) / (total * static_cast<double>(x.size()));
}

// Four sines of equal power: their cross terms average out over 100 s as 1 over 2 pi times the distance of frequencies
// (0.01 to 4 Hz here), so the rms is right to some per cent.
TEST(HandTremor, HasItsRms) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    SCOPED_TRACE(seed);
    const std::vector<double> x = tremble(1e-3, seed, 100);
    double squares = 0;
    for (const double v : x) squares += v * v / static_cast<double>(x.size());
    EXPECT_LE(std::abs(std::sqrt(squares) / 1e-3 - 1), tolerance(0.05));
  }
}

// 0.5 to 40 Hz in steps of 1/20 Hz, the resolution of 20 s: each sine leaks a little past its band.
TEST(HandTremor, StaysInItsBand) {
  const std::vector<double> x = tremble(1e-3, 1, 20);
  double in_band = 0, outside = 0;
  for (int i = 10; i < 800; ++i) {
    const double hertz = 0.05 * i;
    (hertz > 7.8 && hertz < 12.2 ? in_band : outside) += power_at(x, hertz);
  }
  EXPECT_GT(in_band, 0.9);
  EXPECT_LT(outside, 0.05 * in_band);
}

TEST(HandTremor, IsTheSameForTheSameSeedAndAnotherForAnother) {
  EXPECT_EQ(tremble(1e-3, 7, 1), tremble(1e-3, 7, 1));
  EXPECT_NE(tremble(1e-3, 7, 1), tremble(1e-3, 8, 1));
}

// 0.1 m at 0.1 m/s, a quarter turn at 1 rad/s, 0.5 s of dwelling, 1 s of settling.
TEST(Hand, DurationIsItsLegsDwellsAndSettling) {
  const Pose turned{{0.1, 0, 0}, rotation_from_vector({0, 0, kPi / 2})};
  const auto hand = make_hand(reaching({{place(0)}, {place(0.1), 0.1, 0.5}, {turned, 0.1, 0}}));
  EXPECT_LE(std::abs(hand->duration() - (1 + 0.5 + kPi / 2 + 1)), tolerance(1e-14));
}

TEST(Hand, ThatRepeatsHasNoEndAndComesBack) {
  HandDescription description = reaching({{place(0)}, {place(0.1), 0.2, 0}});
  description.repeat = true;
  Living hand(description);
  EXPECT_EQ(hand.device->duration(), 0);
  for (int round = 0; round < 5; ++round) {
    SCOPED_TRACE(round);
    ASSERT_GE(hand.frames_to(0.1, 0.009, 2000), 0);  // it lags 7.75 mm behind a target that turns round
    ASSERT_GE(hand.frames_to(0.0, 0.009, 2000), 0);
  }
}

TEST(Hand, DwellsWhereItIsTold) {
  Living dwelling(reaching({{place(0)}, {place(0.05), 0.1, 1}, {place(0.1), 0.1, 0}}));
  Living hurrying(reaching({{place(0)}, {place(0.05), 0.1, 0}, {place(0.1), 0.1, 0}}));
  const int slow = dwelling.frames_to(0.1, 1e-3, 5000), fast = hurrying.frames_to(0.1, 1e-3, 5000);
  ASSERT_GE(fast, 0);
  EXPECT_LE(std::abs(slow - fast - 1000), 2) << "a dwell of 1 s is 1000 frames, rounded up";
}

// Held up by a wall at 0.05 m, the target waits `lead` ahead of the hand: the force stays at k lead, give or take what
// the target moves within a frame.
TEST(Hand, DoesNotPushHarderThanItsLead) {
  HandDescription description = reaching({{place(0)}, {place(0.2), 0.1, 0}});
  description.lead = 0.01;
  Living hand(description);
  EXPECT_EQ(hand.frames_to(0.2, 1e-3, 5000, 0.05), -1) << "it went through the wall";
  const double force = 5000 * (hand.pose().position.x() - 0.05);
  EXPECT_LE(std::abs(force - 400 * 0.01), tolerance(400 * 0.1 * kStep * 1.5));
}

// Another hand, whose patience ends: it goes back to where it came from and tries again, and again.
TEST(Hand, WithdrawsWhenItsPatienceEnds) {
  HandDescription description = reaching({{place(0)}, {place(0.2), 0.1, 0}});
  description.lead = 0.01;
  description.patience = 0.2;
  Living hand(description);
  for (int attempt = 0; attempt < 3; ++attempt) {
    SCOPED_TRACE(attempt);
    ASSERT_GE(hand.frames_to(0.05, 1e-4, 5000, 0.05), 0);
    ASSERT_GE(hand.frames_to(0.0, 5e-3, 5000, 0.05), 0);
  }
}

// The way back may be slower or faster than the way there: the target turns round where it stands, it does not jump.
TEST(Hand, WithdrawsFromWhereItIsWhateverTheSpeeds) {
  for (const double speed_back : {0.01, 0.1, 1.0}) {
    SCOPED_TRACE(speed_back);
    HandDescription description = reaching({{place(0), speed_back, 0}, {place(0.2), 0.1, 0}});
    description.lead = 0.01;
    description.patience = 0.2;
    Living hand(description);
    double farthest = 0;
    int last_touch = 0;
    for (int i = 0; i < 1500; ++i) {
      const double before = hand.pose().position.x();
      const double depth = before - 0.05;
      hand.frames(1, depth > 0 ? Wrench{{-5000 * depth, 0, 0}, {0, 0, 0}} : Wrench{});
      if (depth > 0) last_touch = i;
      farthest = std::max(farthest, hand.pose().position.x());
      // No hand moves faster than its target, but for the rebound from the wall.
      ASSERT_LE(std::abs(hand.pose().position.x() - before), kStep * 1.5 * std::max(0.1, speed_back)) << i;
    }
    EXPECT_GT(last_touch, 0);
    EXPECT_LT(farthest, 0.052) << "the target jumped into the wall";
  }
}

// Each try misjudges anew, within the error and reproducibly: the numbers pin the order of drawing, which compilers
// would otherwise choose.
TEST(Hand, MisjudgesAnewWithEveryTry) {
  HandDescription description = reaching({{place(0)}, {place(0.2), 0.1, 0}});
  description.lead = 0.01;
  description.patience = 0.1;
  description.error = {0, 0.002, 0.004};
  Living hand(description);
  EXPECT_EQ(hand.pose().position, Vector3d(0, 0.002, 0.004)) << "the first try uses the error itself";
  std::vector<Vector3d> judged;
  for (int attempt = 0; attempt < 3; ++attempt) {
    ASSERT_GE(hand.frames_to(0.05, 1e-4, 5000, 0.05), 0);
    ASSERT_GE(hand.frames_to(0.0, 5e-3, 5000, 0.05), 0);
    judged.push_back(hand.pose().position);
    EXPECT_LE(std::abs(judged.back().y()), 0.002);
    EXPECT_LE(std::abs(judged.back().z()), 0.004);
  }
  EXPECT_GT((judged[0] - judged[1]).tail<2>().norm(), 1e-4);
  // The first retry draws counters 0, 1, 2 for x, y, z.
  const RandomStream retries(description.seed, description.name + " retries");
  const Vector3d expected(0, 0.002 * (2 * retries.uniform(1) - 1), 0.004 * (2 * retries.uniform(2) - 1));
  EXPECT_LE((judged[0] - expected).tail<2>().norm(), tolerance(1e-6));
}

// travel() decides what is voxelized: a hand that got further would meet nothing there.
TEST(Hand, NeverGetsFurtherThanItsTravel) {
  for (const double force : {0.0, 30.0, 1e4}) {
    HandDescription description = reaching({{place(0)}, {place(0.1), 0.5, 0}});
    description.repeat = true;
    description.tremor = 2e-3;
    description.error = {1e-3, -2e-3, 3e-3};
    description.damping = 0.1;  // hardly damped: the tremor's band excites it
    description.mass = 0.1;     // sqrt(k/m) = 10 Hz
    Living hand(description);
    const Vector3d start = hand.pose().position;
    double farthest = 0;
    for (int i = 0; i < 10000; ++i) {
      hand.frames(1, {{force, 0, -force}, {0, 0, 0}});
      farthest = std::max(farthest, (hand.pose().position - start).norm());
    }
    EXPECT_LE(farthest, hand.device->travel() * (1 + tolerance(4 * 0x1p-53)));
    EXPECT_GT(farthest, 0.1);
  }
}

TEST(Hand, RefusesADescriptionThatIsNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  const auto with = [](auto change) {
    return [change] {
      HandDescription hand = reaching({{place(0)}, {place(0.1), 0.1, 0}});
      hand.name = "right";
      change(hand);
      return make_hand(hand);
    };
  };
  expect_refused(with([](auto& h) { h.path.clear(); }), "hand 'right': path has no waypoints");
  expect_refused(with([=](auto& h) { h.path[1].pose.position.z() = nan; }), "waypoint is not finite");
  expect_refused(with([=](auto& h) { h.path[1].pose.rotation.x() = nan; }), "waypoint is not finite");
  expect_refused(with([](auto& h) { h.path[0].pose.rotation.coeffs().setZero(); }), "not a unit quaternion");
  expect_refused(with([](auto& h) { h.lead = 0; }), "lead and patience");
  expect_refused(with([=](auto& h) { h.patience = nan; }), "lead and patience");
  expect_refused(with([=](auto& h) { h.error.y() = nan; }), "error is not finite");
  expect_refused(with([=](auto& h) { h.angular_error.y() = infinity; }), "error is not finite");
  for (const double bad : {0.0, -1.0, nan, infinity}) {
    expect_refused(with([=](auto& h) { h.path[1].speed = bad; }), "speed");
    expect_refused(with([=](auto& h) { h.mass = bad; }), "mass");
    expect_refused(with([=](auto& h) { h.inertia = bad; }), "inertia");
  }
  for (const double bad : {-1.0, nan, infinity}) {
    expect_refused(with([=](auto& h) { h.path[1].dwell = bad; }), "dwell");
    expect_refused(with([=](auto& h) { h.stiffness = bad; }), "stiffness");
    expect_refused(with([=](auto& h) { h.damping = bad; }), "damping");
    expect_refused(with([=](auto& h) { h.angular_stiffness = bad; }), "angularStiffness");
    expect_refused(with([=](auto& h) { h.angular_damping = bad; }), "angularDamping");
    expect_refused(with([=](auto& h) { h.tremor = bad; }), "tremor");
    expect_refused(with([=](auto& h) { h.angular_tremor = bad; }), "tremor");
  }
}

}  // namespace
}  // namespace verisim::hand_test
