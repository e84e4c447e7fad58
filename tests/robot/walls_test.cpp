// Virtual walls: the base never touches one, comes near all the same, and the hand feels a limit.
#include "engine/robot/walls.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "engine/base/pinned_math.hpp"
#include "tests/length.hpp"
#include "tests/support/random_inputs.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::robot::walls_test {
namespace {

WallSettings cave() {
  WallSettings settings;
  settings.corners = rectangle(-2, 2, -1.5, 1.5);  // METaL: 4 x 3 m
  return settings;
}

TrackedBase seen(double x, double y, double theta, double age) {
  return {.pose = {x, y, theta}, .age = age, .is_valid = true, .is_new = true};
}

/// A base that does what Walls are promised of one (walls.hpp), as badly as it may: commands go out every 20 ms, arrive
/// up to 5 ms later, every so often one is lost (never two in a row), the firmware looks at them every 10 ms, velocity
/// follows with a lag, and slows down no faster than the deceleration.
class WorstBase {
 public:
  WorstBase(std::uint64_t seed, const WallSettings& walls, const PlanarPose& pose)
      : random_(seed, "worst base"), lag_(walls.lag), deceleration_(walls.deceleration), pose_(pose) {
    send_phase_ = random_.bits(draws_++) % 20;
    sample_phase_ = random_.bits(draws_++) % 10;
  }
  [[nodiscard]] const PlanarPose& pose() const { return pose_; }

  void advance(const PlanarTwist& commanded) {
    if (ms_ % 20 == send_phase_) {
      was_lost_ = !was_lost_ && random_.uniform(draws_++) < 0.3;
      if (!was_lost_) {
        under_way_ = commanded;
        arrives_ = ms_ + 5 - (random_.bits(draws_++) % 5);
      }
    }
    if (under_way_ && ms_ >= arrives_) heard_ = *under_way_;
    if (ms_ % 10 == sample_phase_) in_force_ = heard_;
    const double c = pinned::cos(pose_.theta), s = pinned::sin(pose_.theta);
    v_.vx += follow(in_force_.vx - v_.vx);
    v_.vy += follow(in_force_.vy - v_.vy);
    v_.omega += (in_force_.omega - v_.omega) * 0.001 / lag_;
    pose_.x += (c * v_.vx - s * v_.vy) * 0.001;
    pose_.y += (s * v_.vx + c * v_.vy) * 0.001;
    pose_.theta += v_.omega * 0.001;
    ++ms_;
  }

 private:
  // Exactly (2) of walls.hpp, each axis for itself; backward Euler, as slow as the bound is.
  [[nodiscard]] double follow(double missing) const {
    const double share = 0.001 / lag_;
    return std::copysign(std::fmin(std::abs(missing) * share / (1 + share), deceleration_ * 0.001), missing);
  }

  RandomStream random_;
  std::uint64_t draws_ = 0;
  double lag_, deceleration_;
  PlanarPose pose_;
  PlanarTwist heard_, in_force_, v_;
  std::optional<PlanarTwist> under_way_;
  std::uint64_t ms_ = 0, arrives_ = 0, send_phase_ = 0, sample_phase_ = 0;
  bool was_lost_ = false;
};

struct Walked {
  double nearest = 1e9;  ///< m from the disc to a wall
  double way = 0;        ///< m
};

double distance_to_wall(const PlanarPose& p, const WallSettings& walls) {
  double least = 1e9;
  const std::size_t n = walls.corners.size();
  for (std::size_t k = 0; k < n; ++k) {
    const auto &a = walls.corners[k], &b = walls.corners[(k + 1) % n];
    const double ex = b[0] - a[0], ey = b[1] - a[1];
    least = std::fmin(least, (ex * (p.y - a[1]) - ey * (p.x - a[0])) / std::sqrt(ex * ex + ey * ey));
  }
  return least - walls.radius;
}

/// A person walks at random, through walls too, and the base follows at a random gain.
Walked walk(std::uint64_t seed, const WallSettings& settings, bool is_limited, bool turns) {
  test::Inputs inputs(seed);
  BaseTrackerSettings tracking;
  tracking.latency = inputs.between(0, 0.08);
  tracking.sigma_position = 0.001;
  tracking.dropout_rate = inputs.between(0, 1);
  tracking.dropout_mean = inputs.between(0.05, 1);
  tracking.lost_after = 0.2;
  BaseTracker tracker(tracking, seed, "art");
  Walls walls(settings);
  WorstBase base(seed, settings, {inputs.between(-0.5, 0.5), inputs.between(-0.3, 0.3), inputs.between(-4, 4)});
  const double gain = std::pow(10, inputs.between(0, 3));
  double hand_x = 0, hand_y = 0, to_x = 0, to_y = 0, turn = 0;
  Walked walked;
  for (int ms = 0; ms < 8000; ++ms) {
    if (ms % 3000 == 0) {
      to_x = std::copysign(inputs.between(1, 6), inputs.between(-1, 1));
      to_y = std::copysign(inputs.between(1, 6), inputs.between(-1, 1));
      turn = turns ? inputs.between(-0.5, 0.5) : 0;
    }
    hand_x += (to_x - hand_x) * 0.003;
    hand_y += (to_y - hand_y) * 0.003;
    const PlanarPose& X = base.pose();
    const double c = pinned::cos(X.theta), s = pinned::sin(X.theta);
    const double ex = gain * (hand_x - X.x), ey = gain * (hand_y - X.y);
    const double scale = std::fmin(1, settings.speed_max / (std::abs(ex) + std::abs(ey) + 1e-9));
    const PlanarTwist wanted{scale * (c * ex + s * ey), scale * (-s * ex + c * ey), turn};
    const TrackedBase& tracked = tracker.advance(X);
    const PlanarPose before = X;
    base.advance(is_limited ? walls.limit(wanted, tracked) : wanted);
    walked.way += std::sqrt(std::pow(base.pose().x - before.x, 2) + std::pow(base.pose().y - before.y, 2));
    walked.nearest = std::fmin(walked.nearest, distance_to_wall(base.pose(), settings));
  }
  return walked;
}

// The number of the issue: never touched in 1,000 seeded walks with latency and dropouts, at gains from 1 to 1000.
TEST(Walls, AreNeverTouchedInAThousandWalks) {
  double nearest = 1e9, way = 0;
  int came_near = 0, touched_without = 0;
  const int walks = test::by_length(60, 1000, 1000);
  for (const std::uint64_t seed : test::seeds(static_cast<std::uint64_t>(walks))) {
    const Walked walked = walk(seed, cave(), true, seed % 2 == 0);
    ASSERT_GT(walked.nearest, 0) << seed;
    nearest = std::fmin(nearest, walked.nearest);
    way += walked.way / walks;
    came_near += walked.nearest < 0.10 ? 1 : 0;
    if (seed <= 50) touched_without += walk(seed, cave(), false, seed % 2 == 0).nearest < 0 ? 1 : 0;
  }
  RecordProperty("nearest", std::to_string(nearest));
  RecordProperty("way", std::to_string(way));
  EXPECT_GT(came_near, walks / 2) << "walls that keep the base in the middle of the room would prove little";
  EXPECT_GT(touched_without, 25) << "nor would walks that touch nothing without walls";
  EXPECT_GT(way, 1) << "nor would a base that stands";
  std::printf("nearest %.4f m, %.2f m walked on average, %d of %d within 10 cm\n", nearest, way, came_near, walks);
}

TEST(Walls, OfARoomWithSharpCornersAreNotTouchedEither) {
  WallSettings settings = cave();
  settings.corners = {{-2.5, -1.5}, {2.5, -1.5}, {0.5, 2.2}};
  for (const std::uint64_t seed : test::seeds(test::by_length<std::uint64_t>(20, 200, 200)))
    ASSERT_GT(walk(seed, settings, true, true).nearest, 0) << seed;
}

// The server dies: its last command stays in force for 250 ms and ends within 200 more. With a delay that holds this
// time the wall is not touched; the base stands first, because the tracker has to have seen it.
TEST(Walls, WithADelayForTheWatchdogHoldWhenTheServerDies) {
  for (const std::uint64_t seed : test::seeds(100)) {
    WallSettings settings = cave();
    settings.delay = 0.36;
    test::Inputs inputs(seed);
    Walls walls(settings);
    WorstBase base(seed, settings, {0, 0, inputs.between(-3, 3)});
    const int dies = static_cast<int>(inputs.between(500, 6000));
    PlanarTwist last;
    for (int ms = 0; ms < dies + 1500; ++ms) {
      const double c = pinned::cos(base.pose().theta), s = pinned::sin(base.pose().theta);
      const TrackedBase tracked = seen(base.pose().x, base.pose().y, base.pose().theta, 0.02);
      if (ms < dies) last = walls.limit({0.57 * c, -0.57 * s, 0}, tracked);
      const double left = std::fmin(1, std::fmax(0, 1 - (ms - dies - 250) / 200.0));
      base.advance({last.vx * left, last.vy * left, 0});
    }
    EXPECT_GT(distance_to_wall(base.pose(), settings), 0) << seed;
  }
}

// In the middle of the room nothing is limited: 0.57 m/s ahead, 1.7 m in front of the wall.
TEST(Walls, LeaveTheBaseAloneFarFromThem) {
  Walls walls(cave());
  PlanarTwist out;
  for (int ms = 0; ms < 200; ++ms) out = walls.limit({0.57, 0, 0.2}, seen(0, 0, 0, 0.02));
  EXPECT_EQ(out.vx, 0.57);
  EXPECT_EQ(out.vy, 0);
  EXPECT_EQ(out.omega, 0.2);
  EXPECT_FALSE(walls.is_limiting());
}

// At rest e is 0 and r = distance - radius - margin: kappa r toward the wall, less what direction and rounding may add.
TEST(Walls, AllowKappaTimesTheRoomLeft) {
  Walls walls(cave());
  const double r = 0.05;
  const TrackedBase tracked = seen(2 - 0.27 - 0.010 - r, 0, 0, 0);
  const double lambda = 1 / (0.060 + 0.001 + 0.080 + 0.573 / 3);
  const double kappa = lambda * (1 - lambda * 0.080) * std::exp(-lambda * 0.061);
  EXPECT_NEAR(walls.kappa(), kappa, test::tolerance(1e-12));
  const PlanarTwist out = walls.limit({0.5, 0, 0}, tracked);
  EXPECT_LE(out.vx, kappa * r);
  const double delta = 0.010 + 0.5 * (0.060 + 0.160);
  EXPECT_GE(out.vx, kappa * r - delta * 1.2 * 0.5 - 0.001);
  EXPECT_NEAR(walls.room_left(), r, test::tolerance(1e-12));
  EXPECT_TRUE(walls.is_limiting());
}

// Along a wall the base goes on, whichever way it stands; away from it too.
TEST(Walls, LetTheBaseSlideAlongAndAway) {
  for (const double theta : {0.0, 1.0, 3.0}) {
    Walls walls(cave());
    const TrackedBase tracked = seen(2 - 0.27 - 0.010, 0, theta, 0.02);
    const double c = std::cos(theta), s = std::sin(theta);
    const PlanarTwist along = walls.limit({0.3 * c + 0.3 * s, -0.3 * s + 0.3 * c, 0}, tracked);  // F: (0.3, 0.3)
    EXPECT_GT(s * along.vx + c * along.vy, 0.29);
    EXPECT_LE(c * along.vx - s * along.vy, 0);
    const PlanarTwist away = walls.limit({-0.3 * c, 0.3 * s, 0}, tracked);
    EXPECT_NEAR(c * away.vx - s * away.vy, -0.3, test::tolerance(1e-15));
  }
}

// At the wall a spring to the neutral point, 200 N/m x 30 mm = 6 N, whatever the gain; none without a wall; 10 N at
// most.
TEST(Walls, HandFeelsASpringWhereTheBaseMayNotFollow) {
  for (const double speed : {0.05, 0.57}) {
    Walls walls(cave());
    (void)walls.limit({speed, 0, 0}, seen(2 - 0.27 - 0.010, 0, 0, 0.02));
    EXPECT_NEAR(walls.limit_force({0.030, 0.020})[0], -6, test::tolerance(1e-12));
    EXPECT_EQ(walls.limit_force({0.030, 0.020})[1], 0) << "along the wall it follows";
    EXPECT_NEAR(walls.limit_force({0.200, 0})[0], -10, test::tolerance(1e-12));
    EXPECT_EQ(walls.limit_force({std::nan(""), 0})[0], 0);
    (void)walls.limit({-speed, 0, 0}, seen(2 - 0.27 - 0.010, 0, 0, 0.02));
    EXPECT_EQ(walls.limit_force({-0.030, 0})[0], 0);
    (void)walls.limit({speed, 0, 0}, seen(0, 0, 0, 0.02));
    EXPECT_EQ(walls.limit_force({0.030, 0})[0], 0);
  }
}

// A base that comes at 0.3 m/s: the force begins at nothing and grows without a jump that the hand would feel.
TEST(Walls, ForceGrowsWithoutAJump) {
  Walls walls(cave());
  double x = 0, last = 0, largest = 0;
  for (int ms = 0; ms < 8000; ++ms) {
    const PlanarTwist out = walls.limit({0.3, 0, 0}, seen(x, 0, 0, 0));
    x += out.vx * 0.001;
    const double force = walls.limit_force({0.06, 0})[0];
    EXPECT_LE(force, 0);
    largest = std::fmax(largest, std::abs(force - last));
    last = force;
  }
  EXPECT_LT(last, -9);
  EXPECT_LT(largest, 0.05) << "N in a millisecond";
}

TEST(Walls, BaseThatWasNeverSeenStands) {
  Walls walls(cave());
  BaseTracker tracker({}, 1, "art");
  const PlanarTwist out = walls.limit({0.3, 0.1, 0}, tracker.tracked());
  EXPECT_EQ(out.vx, 0);
  EXPECT_EQ(out.vy, 0);
}

// Outside, or pushed into a wall: toward it nothing, back all.
TEST(Walls, BaseOutsideComesBack) {
  Walls walls(cave());
  EXPECT_LE(walls.limit({0.3, 0, 0}, seen(2.5, 0, 0, 0.02)).vx, 0);
  EXPECT_NEAR(walls.limit({-0.3, 0, 0}, seen(2.5, 0, 0, 0.02)).vx, -0.3, test::tolerance(1e-15));
}

TEST(Walls, SayWhenTheyHoldAndWhenTheyLetGo) {
  Walls walls(cave());
  RobotNotes notes;
  for (int ms = 0; ms < 10; ++ms) (void)walls.limit({0.3, 0, 0}, seen(1.7, 0, 0, 0.02));
  walls.report(notes);
  for (int ms = 0; ms < 300; ++ms) (void)walls.limit({-0.3, 0, 0}, seen(1.7, 0, 0, 0.02));
  walls.report(notes);
  ASSERT_EQ(notes.size(), 2U);
  EXPECT_STREQ(notes.begin()[0].text, "hold the base back");
  EXPECT_STREQ(notes.begin()[1].text, "let the base go");
}

TEST(Walls, RefuseRoomsThatAreNone) {
  const auto made = [](void (*change)(WallSettings&)) {
    return [change] {
      WallSettings settings = cave();
      change(settings);
      return Walls(settings).kappa();
    };
  };
  test::expect_refused(made([](auto& s) { s.corners.pop_back(), s.corners.pop_back(); }), "the number of corners is 2");
  test::expect_refused(made([](auto& s) { std::swap(s.corners[1], s.corners[3]); }), "not those of a convex room");
  test::expect_refused(made([](auto& s) { s.corners[1] = s.corners[0]; }), "stands twice");
  test::expect_refused(made([](auto& s) { s.corners[2] = {-1, -1}; }), "not those of a convex room");
  test::expect_refused(made([](auto& s) { s.radius = 1.6; }), "a base of radius 1.6 m has no room");
  test::expect_refused(made([](auto& s) { s.corners[0][0] = std::nan(""); }), "a corner's coordinate is nan");
  test::expect_refused(made([](auto& s) { s.deceleration = 0; }), "deceleration is 0");
}

}  // namespace
}  // namespace verisim::robot::walls_test
