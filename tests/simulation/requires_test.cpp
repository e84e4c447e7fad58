// DESIGN rule 2: pay for what the scene requires. What cannot meet anything is not voxelized and not queried.
#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "tests/simulation/scenes.hpp"

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
  const auto frames_of = [](int far_parts) {
    Scene scene = scenes::falling_boxes(3, Integrator::semi_implicit);
    for (int i = 0; i < far_parts; ++i) {
      BodyDescription part = scenes::body_of("part" + std::to_string(i), scenes::centred_box({0.05, 0.05, 0.05}), -1);
      part.fixed = true;
      part.X_WB.position = {2 + 0.2 * (i % 20), 0.2 * (i / 20), -5};
      scene.bodies.push_back(part);
    }
    scene.parameters.all_bodies_are_dynamic = false;
    for (std::size_t i = 1; i <= 3; ++i) {
      const Pose& start = scene.bodies[i].X_WB;
      HandDescription hand;
      hand.name = "hand" + std::to_string(i);
      hand.path = {{start}, {{start.position - Vector3d(0, 0, 0.03), start.rotation}, 0.2}};
      scene.devices.push_back(make_hand(hand));
      scene.grasps.push_back({i - 1, i});
    }
    Simulation simulation(std::move(scene), {});
    std::vector<FrameCost> costs;
    while (simulation.frame() < 400) {
      simulation.prepare();
      simulation.step();
      costs.push_back(simulation.cost());
    }
    return costs;
  };
  const std::vector<FrameCost> few = frames_of(0), many = frames_of(197);
  std::uint64_t contacts = 0;
  for (std::size_t i = 0; i < few.size(); ++i) {
    contacts += few[i].contacts;
    for (const CostCounter& counter : kCostCounters)
      EXPECT_EQ(many[i].*counter.count, few[i].*counter.count) << counter.name << " in frame " << i;
  }
  EXPECT_GT(contacts, 0U);
}

}  // namespace
}  // namespace verisim::requires_test
