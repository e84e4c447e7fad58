#include "tests/exact/seated_cone.hpp"

#include <gtest/gtest.h>

#include "tests/support/tolerance.hpp"

namespace verisim::exact::test::seated_cone_test {
namespace {

using verisim::test::tolerance;

// It fits all over: pressed down it comes to where it was cut from, upright, though the hand shakes and turns it.
TEST(SeatedCone, RestsWhereItFits) {
  HeldBody cone = seated_cone();
  for (int i = 0; i < kSeatSteps; ++i) {
    cone.step(hand_over_seat(i * cone.dt));
    if (i < 500) continue;
    ASSERT_LE(cone.X_WB.position.norm(), tolerance(1e-9)) << "frame " << i;
    ASSERT_LE((cone.X_WB.rotation * Vector3d::UnitZ()).head<2>().norm(), tolerance(1e-7)) << "frame " << i;
    ASSERT_GT(cone.contact_force.z(), 0.1);
  }
}

// Every sample of four rims is within nanometres of two faces. Those that another face owns are culled by the block:
// hardly a sample is moved to its closest place that does not become a row.
TEST(SeatedCone, SearchesHardlyMoreSamplesThanTouch) {
  HeldBody cone = seated_cone();
  std::uint64_t closest_places = 0;
  std::uint64_t rows = 0;
  for (int i = 0; i < kSeatSteps; ++i) {
    cone.step(hand_over_seat(i * cone.dt));
    if (i < 500) continue;
    closest_places += cone.link.cost().closest_places;
    rows += cone.link.cost().rows;
  }
  EXPECT_GT(rows, 40'000);
  EXPECT_LE(closest_places, 1.1 * static_cast<double>(rows));
}

}  // namespace
}  // namespace verisim::exact::test::seated_cone_test
