// The search for the remote's place.
#include "engine/wii/place.hpp"

#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "tests/length.hpp"

namespace verisim::wii::place_test {
namespace {

PlaceOptions seated_in_front_of_a_screen(int heads = 300) {
  PlaceOptions options;
  options.heads = modelled_heads({0, 1.2, 1}, {0, 1.2, 0}, {0.15, 0.05, 0.1}, heads, 1);
  options.room_min = {-0.6, 0.7, -0.3};
  options.room_max = {0.6, 1.7, 0.1};
  return options;
}

TEST(Place, LooksBackAtASingleHead) {
  PlaceOptions options;
  options.heads = {{{0, 0, 1}, Quaterniond::Identity()}};
  options.room_min = options.room_max = {0.2, 0.1, 0};
  const Placement best = good_places(options).front();
  EXPECT_EQ(best.covered, 1);
  EXPECT_LT(std::abs(best.heading - pinned::atan2(-0.2, 1)), 21.5 * kDegree);
  EXPECT_LT(std::abs(best.pitch - pinned::atan2(-0.1, 1)), 16 * kDegree);
}

TEST(Place, IsNoWorseThanAnyPlaceOfACoarseGrid) {
  const PlaceOptions options = seated_in_front_of_a_screen(test::by_length(50, 300, 300));
  const Placement best = good_places(options).front();
  for (const double x : {-0.5, 0.0, 0.5})
    for (const double y : {0.8, 1.2, 1.6})
      for (const double heading : {-0.3, 0.0, 0.3})
        for (const double pitch : {-0.3, 0.0, 0.3})
          EXPECT_LE(judge_place(options, {x, y, -0.2}, heading, pitch).covered, best.covered + 0.001);
}

TEST(Place, StaysInTheRoomAndSeesNearlyEverySeatedHead) {
  const PlaceOptions options = seated_in_front_of_a_screen(test::by_length(50, 300, 300));
  const Placement best = good_places(options).front();
  EXPECT_TRUE((best.X_WR.position.array() >= options.room_min.array()).all());
  EXPECT_TRUE((best.X_WR.position.array() <= options.room_max.array()).all());
  EXPECT_GT(best.covered, 0.98);
  EXPECT_LT(best.error, 0.02);
}

// Sides that roundings cannot divide: a corner of the search's grid is a corner of the room.
TEST(Place, StaysInRoomsOfAnySize) {
  const RandomStream random(1, "rooms");
  for (std::uint64_t i = 0; i < test::by_length<std::uint64_t>(10, 100, 1000); ++i) {
    PlaceOptions options = seated_in_front_of_a_screen(10);
    options.search.grid = 2;
    for (int axis = 0; axis < 3; ++axis) {
      options.room_min[axis] = (axis == 1 ? 1.2 : 0) - 0.4 * random.uniform(6 * i + 2 * axis);
      options.room_max[axis] = (axis == 1 ? 1.2 : 0) + 0.1 * random.uniform(6 * i + 2 * axis + 1);
    }
    for (const Placement& place : good_places(options)) {
      EXPECT_TRUE((place.X_WR.position.array() >= options.room_min.array()).all()) << i;
      EXPECT_TRUE((place.X_WR.position.array() <= options.room_max.array()).all()) << i;
    }
  }
}

TEST(Place, RefusesNoHeadsAndAnInvertedRoom) {
  PlaceOptions options;
  EXPECT_THROW((void)good_places(options).front(), Error);
  options.heads = {{{0, 0, 1}, Quaterniond::Identity()}};
  std::swap(options.room_min, options.room_max);
  EXPECT_THROW((void)good_places(options).front(), Error);
}

PlaceOptions with_the_screen() {
  PlaceOptions options = seated_in_front_of_a_screen();
  options.obstacles = {screen_at({0, 1.2, 0}, {0, 1.2, 1}, 0.6, 0.35)};
  return options;
}

TEST(Place, IsAListOfWhichNoneDominatesAnother) {
  const std::vector<Placement> places = good_places(with_the_screen());
  ASSERT_GE(places.size(), 3U);
  for (std::size_t i = 1; i < places.size(); ++i) {
    EXPECT_LT(places[i].error, places[i - 1].error);
    EXPECT_LT(places[i].covered, places[i - 1].covered + 0.001);
  }
}

// A straight walk from the remote to each LED, a millimetre at a time, is the ruler.
TEST(Place, NothingIsSeenThroughAnObstacle) {
  PlaceOptions options = with_the_screen();
  options.obstacles.push_back({{{0.3, 1.3, 0.5}, Quaterniond::Identity()}, {0.05, 0.2, 0.01}});
  /// How far inside an obstacle [m], along the axis on which it is least.
  const auto depth = [&](const Vector3d& p_W) {
    double deepest = -1;
    for (const Obstacle& o : options.obstacles)
      deepest = std::max(deepest, (o.half - (o.X_WO.inverse() * p_W).cwiseAbs()).minCoeff());
    return deepest;
  };
  int hidden = 0;
  for (const Vector3d& p : {Vector3d(0, 1.2, -0.3), Vector3d(0.4, 1.3, -0.2), Vector3d(0, 1.5, 0.05)}) {
    const Pose X_WR{p, rotation_from_vector({0, std::atan2(-p.x(), 1 - p.z()), 0})};
    const std::vector<Lost> lost = lost_heads(options, X_WR);
    for (std::size_t i = 0; i < options.heads.size(); ++i) {
      double deepest = -1;
      for (const std::size_t led : {std::size_t{0}, std::size_t{1}}) {
        const Vector3d p_W = options.heads[i] * options.tracker.leds.p_H[led];
        for (double s = 0; s <= 1; s += 0.0005) deepest = std::max(deepest, depth(p + s * (p_W - p)));
      }
      EXPECT_FALSE(lost[i] == Lost::no && deepest > 0) << i;
      EXPECT_FALSE(lost[i] == Lost::hidden && deepest < -0.001) << i << ": a step beside its edge at most";
      hidden += lost[i] == Lost::hidden ? 1 : 0;
    }
  }
  EXPECT_GT(hidden, 300);
  EXPECT_EQ(judge_place(options, {0, 1.2, 0}, 0, 0).covered, 0) << "within the screen";
}

TEST(Place, SaysWhichHeadsAreLostAndWhy) {
  PlaceOptions options;
  const auto at = [](const Vector3d& p, double yaw) { return Pose{p, head_rotation(yaw, 0, 0)}; };
  options.heads = {at({0, 0, 1}, 0), at({0, 0, 0.15}, 0), at({0, 0, 6}, 0),
                   at({1, 0, 1}, 0), at({0, 0, 1.5}, 2),  at({0, 0, -1}, 0)};
  const std::vector<Lost> lost = lost_heads(options, Pose());
  EXPECT_EQ(lost, (std::vector<Lost>{Lost::no, Lost::too_near, Lost::too_far, Lost::out_of_view, Lost::turned_away,
                                     Lost::out_of_view}));
}

}  // namespace
}  // namespace verisim::wii::place_test
