// Broken promises end at the doors of the loop; what a user can do wrong is an error there, not a broken promise.
#include <gtest/gtest.h>

#include <limits>

#include "engine/base/error.hpp"
#include "engine/simulation/declaring.hpp"
#include "tests/simulation/scenes.hpp"
#include "tests/support/broken.hpp"

namespace verisim::simulation_contracts_test {
namespace {

TEST(SimulationDeathTest, IsMadeOfDevicesAndCompanionsThatAreThere) {
  Scene scene = scenes::pin_in_hole();
  scene.devices.push_back(nullptr);
  EXPECT_BROKEN(Simulation(scene, {}), "device != nullptr");
  scene = scenes::pin_in_hole();
  scene.companions.push_back(nullptr);
  EXPECT_BROKEN(Simulation(scene, {}), "companion != nullptr");
}

TEST(SimulationDeathTest, IsAskedForMethodsThatAreThere) {
  Scene scene = scenes::pin_in_hole();
  scene.parameters.hybrid = nullptr;
  EXPECT_BROKEN(Simulation(scene, {}), "scene.parameters.hybrid != nullptr");
  scene = scenes::pin_in_hole();
  scene.bodies[0].hybrid = Hybrid{nullptr};
  EXPECT_BROKEN(Simulation(scene, {}), "!body.hybrid || *body.hybrid != nullptr");
}

TEST(SimulationDeathTest, HoldsBodiesOfTheSceneWithItsDevices) {
  Scene scene = scenes::pin_in_hole();
  scene.grasps = {{1, 1}};
  EXPECT_BROKEN(Simulation(scene, {}), "grasp.device < scene.devices.size()");
  scene.grasps = {{0, 2}};
  EXPECT_BROKEN(Simulation(scene, {}), "grasp.body < scene.bodies.size()");
  scene = scenes::pin_in_hole();
  scene.grasp_distance = std::numeric_limits<double>::quiet_NaN();
  EXPECT_BROKEN(Simulation(scene, {}), "is_positive(scene.grasp_distance)");
  Simulation simulation(scenes::pin_in_hole(), {});
  EXPECT_BROKEN(simulation.grasp(1, 1), "h < world.hands.size()");
  EXPECT_BROKEN(simulation.grasp(0, 2), "index < world.bodies.size()");
  EXPECT_BROKEN(simulation.release(1), "h < world.hands.size()");
}

TEST(SimulationDeathTest, CallsWhatIsThere) {
  Simulation simulation(scenes::pin_in_hole(), {});
  EXPECT_BROKEN(simulation.add_clock(60, nullptr), "f != nullptr");
  EXPECT_BROKEN(simulation.write_row(nullptr), "row != nullptr");
}

TEST(DeclaringDeathTest, IsOfTheBodyThatWasVoxelized) {
  BodyDescription body = scenes::pin_in_hole().bodies[0];
  const Declaring voxels(body);
  EXPECT_BROKEN(voxels.center(voxels.surface_voxels()), "voxel < surface_voxels()");
  const Vector3d p = voxels.center(0);
  body.voxel_size *= 2;
  EXPECT_BROKEN(voxels.give(body, p, {}), "body.voxel_size == voxels_.voxmap.voxel_size");
}

TEST(Simulation, RefusesABodyThatStartsNowhereOrAtNoSpeed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Scene scene = scenes::pin_in_hole();
  scene.bodies[1].X_WB.position.x() = nan;
  EXPECT_THROW(Simulation(scene, {}), Error);
  scene = scenes::pin_in_hole();
  scene.bodies[1].twist.angular.z() = std::numeric_limits<double>::infinity();
  EXPECT_THROW(Simulation(scene, {}), Error);
}

}  // namespace
}  // namespace verisim::simulation_contracts_test
