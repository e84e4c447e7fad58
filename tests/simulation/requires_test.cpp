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

}  // namespace
}  // namespace verisim::requires_test
