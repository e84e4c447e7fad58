// DESIGN rule 2: pay for what the scene requires. What cannot meet anything is not voxelized and not queried.
#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "tests/simulation/few_move_scene.hpp"

namespace verisim::requires_test {
namespace {

TEST(Requires, ASceneWithoutAnythingThatMovesCostsNothing) {
  Scene scene = scenes::pin_in_hole();
  scene.devices.clear();
  scene.grasps.clear();
  Simulation simulation(std::move(scene), {});
  simulation.step();
  EXPECT_EQ(simulation.pairs().size(), 0U);
  EXPECT_EQ(simulation.cost().pairs_tested, 0U);
  EXPECT_EQ(simulation.cost().points_tested, 0U);
}

// A voxel size that voxelize() would refuse shows whether it was asked at all.
TEST(Requires, APartThatTheHandCannotReachIsNeverVoxelized) {
  Scene scene = scenes::pin_in_hole();
  BodyDescription far = scenes::body_of("far", scenes::centred_box({1, 1, 1}), -1);
  far.fixed = true;
  far.X_WB.position = {100, 0, 0};
  scene.bodies.push_back(far);
  EXPECT_NO_THROW(Simulation(std::move(scene), {}));
}

TEST(Requires, TheSamePartWithinReachIsVoxelized) {
  Scene scene = scenes::pin_in_hole();
  BodyDescription near = scenes::body_of("near", scenes::centred_box({0.1, 0.1, 0.1}), -1);
  near.fixed = true;
  near.X_WB.position = {0.3, 0, 0};
  scene.bodies.push_back(near);
  EXPECT_THROW(Simulation(std::move(scene), {}), Error);
}

TEST(Requires, BodiesApartCostABroadPhaseOnly) {
  Scene scene = scenes::falling_boxes(2, Integrator::semi_implicit);
  scene.bodies[1].X_WB.position.z() += 0.1;
  scene.bodies[2].X_WB.position.z() += 0.2;
  Simulation simulation(std::move(scene), {});
  simulation.step();
  EXPECT_EQ(simulation.cost().points_tested, 0U);
  EXPECT_EQ(simulation.cost().contacts, 0U);
}

// 200 parts of which 3 move: what the 3 do to each other and to the plate is all that is counted, in every frame.
TEST(Requires, PartsThatNothingComesNearCostNoWork) {
  const auto frames_of = [](int others, bool fixed) {
    Simulation simulation(scenes::three_move_among(others, fixed), {});
    std::vector<FrameCost> costs;
    while (simulation.frame() < 400) {
      simulation.prepare();
      simulation.step();
      costs.push_back(simulation.cost());
    }
    return costs;
  };
  const std::vector<FrameCost> few = frames_of(0, true);
  for (const bool fixed : {true, false}) {
    const std::vector<FrameCost> many = frames_of(197, fixed);
    std::uint64_t contacts = 0;
    for (std::size_t i = 0; i < few.size(); ++i) {
      contacts += few[i].contacts;
      for (const CostCounter& counter : kCostCounters)
        EXPECT_EQ(many[i].*counter.count, few[i].*counter.count) << counter.name << " in frame " << i;
    }
    EXPECT_GT(contacts, 0U);
  }
}

}  // namespace
}  // namespace verisim::requires_test
