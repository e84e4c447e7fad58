// The search for the remote's place.
#include "engine/wii/place.hpp"

#include <gtest/gtest.h>

#include "engine/base/error.hpp"

namespace verisim::wii::place_test {
namespace {

PlaceOptions seated_in_front_of_a_screen() {
  PlaceOptions options;
  options.heads = modelled_heads({0, 1.2, 1}, {0, 1.2, 0}, {0.15, 0.05, 0.1}, 300, 1);
  options.room_min = {-0.6, 0.7, -0.3};
  options.room_max = {0.6, 1.7, 0.1};
  return options;
}

TEST(Place, LooksBackAtASingleHead) {
  PlaceOptions options;
  options.heads = {{{0, 0, 1}, Quaterniond::Identity()}};
  options.room_min = options.room_max = {0.2, 0.1, 0};
  const Placement best = best_place(options);
  EXPECT_EQ(best.covered, 1);
  EXPECT_LT(std::abs(best.heading - pinned::atan2(-0.2, 1)), 21.5 * kDegree);
  EXPECT_LT(std::abs(best.pitch - pinned::atan2(-0.1, 1)), 16 * kDegree);
}

TEST(Place, IsNoWorseThanAnyPlaceOfACoarseGrid) {
  const PlaceOptions options = seated_in_front_of_a_screen();
  const Placement best = best_place(options);
  for (const double x : {-0.5, 0.0, 0.5})
    for (const double y : {0.8, 1.2, 1.6})
      for (const double heading : {-0.3, 0.0, 0.3})
        for (const double pitch : {-0.3, 0.0, 0.3})
          EXPECT_LE(judge_place(options, {x, y, -0.2}, heading, pitch).covered, best.covered + 0.001);
}

TEST(Place, StaysInTheRoomAndSeesNearlyEverySeatedHead) {
  const PlaceOptions options = seated_in_front_of_a_screen();
  const Placement best = best_place(options);
  EXPECT_TRUE((best.X_WR.position.array() >= options.room_min.array()).all());
  EXPECT_TRUE((best.X_WR.position.array() <= options.room_max.array()).all());
  EXPECT_GT(best.covered, 0.98);
  EXPECT_LT(best.error, 0.02);
}

TEST(Place, RefusesNoHeadsAndAnInvertedRoom) {
  PlaceOptions options;
  EXPECT_THROW((void)best_place(options), Error);
  options.heads = {{{0, 0, 1}, Quaterniond::Identity()}};
  std::swap(options.room_min, options.room_max);
  EXPECT_THROW((void)best_place(options), Error);
}

}  // namespace
}  // namespace verisim::wii::place_test
