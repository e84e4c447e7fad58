// Fast bodies under exact: contact is found before the bodies overlap, however far they go within a step and however
// small their voxels are.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/simulation/hybrid_scenes.hpp"

namespace verisim::exact_speed_test {
namespace {

constexpr std::size_t kBox = 1;

/// A box flies flat against a plate.
Scene flying_box(double voxel_size) {
  Scene scene;
  scene.parameters.hybrid = hybrid::exact;
  scene.parameters.integrator = Integrator::implicit;
  scene.parameters.all_bodies_are_dynamic = true;
  scene.parameters.duration = 0.03;
  scene.bodies.push_back(scenes::body_of("plate", *scenes::solid(Solid::Kind::box, {0.02, 0.02, 0.005}), voxel_size));
  scene.bodies.push_back(scenes::body_of("box", *scenes::solid(Solid::Kind::box, {0.01, 0.01, 0.005}), voxel_size));
  scene.bodies[0].fixed = true;
  scene.bodies[kBox].density = 1000;
  return scene;
}

// The plate's face stops the box within the one step in which it would pass it; it neither sinks in nor comes back.
TEST(FastBox, IsStoppedAtThePlateWhateverTheVoxels) {
  for (const double voxel_size : {0.0004, 0.002}) {
    Scene scene = flying_box(voxel_size);
    for (const double speed : {3.0, 10.0}) {
      for (int part = 0; part < 5; ++part) {  // of a step, at which the box arrives
        const double gap = 0.02 + 0.2 * part * speed * 0.001;
        scene.bodies[kBox].X_WB.position = {0, 0, 0.005 + gap};
        scene.bodies[kBox].twist.linear = {0, 0, -speed};
        Simulation simulation(scene, {});
        double lowest = gap;
        while (simulation.frame() < simulation.frames_planned()) {
          simulation.step();
          lowest = std::min(lowest, simulation.body_pose(kBox).position.z() - 0.005);
        }
        SCOPED_TRACE(testing::Message() << speed << " m/s, voxels of " << voxel_size << " m, arrives at " << part);
        ASSERT_GT(lowest, -1e-7);
        ASSERT_LT(simulation.body_pose(kBox).position.z() - 0.005, 1e-5);
      }
    }
  }
}

// What is looked ahead for is what a body does already and a little more: a jump of its speed says so.
TEST(FastBox, SaysThatAContactMayBeLateWhenItsSpeedJumps) {
  const auto late = [](double acceleration) {
    Scene scene = flying_box(0.002);
    scene.parameters.gravity = {0, 0, -acceleration};
    scene.bodies[kBox].X_WB.position = {0, 0, 1};
    Simulation simulation(std::move(scene), {});
    for (int i = 0; i < 5; ++i) simulation.step();
    return std::count_if(simulation.events().begin(), simulation.events().end(),
                         [](const Event& event) { return event.kind == "late contact"; });
  };
  EXPECT_EQ(late(9.81), 0);
  EXPECT_EQ(late(1e5), 1) << "once for the body";
}

}  // namespace
}  // namespace verisim::exact_speed_test
