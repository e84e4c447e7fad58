#include <gtest/gtest.h>

#include "tests/simulation/scenes.hpp"

namespace verisim::grasp_test {
namespace {

HapticSamples still_with_button(const Vector3d& p, std::vector<std::uint8_t> button) {
  HapticSamples samples;
  for (std::size_t i = 0; i < button.size(); ++i) {
    samples.t.push_back(0.01 * static_cast<double>(i));
    samples.pose.push_back({p, Quaterniond::Identity()});
  }
  samples.button = std::move(button);
  return samples;
}

Scene two_boxes(const Vector3d& handle, std::vector<std::uint8_t> button) {
  Scene scene;
  scene.parameters.duration = 0.05;
  for (const double x : {-0.2, 0.2}) {
    BodyDescription box = scenes::body_of(x < 0 ? "left" : "right", scenes::centred_box({0.1, 0.1, 0.1}), 0.01);
    box.X_WB.position = {x, 0, 0};
    scene.bodies.push_back(box);
  }
  scene.devices = {make_replay("stylus", still_with_button(handle, std::move(button)))};
  return scene;
}

std::vector<std::string> events_of(Scene scene) {
  Simulation simulation(std::move(scene), {});
  while (simulation.frame() < simulation.frames_planned()) simulation.step();
  std::vector<std::string> texts;
  for (const Event& event : simulation.events())
    if (event.kind == "grasp" || event.kind == "release") texts.push_back(event.text);
  return texts;
}

TEST(Grasp, TheButtonTakesTheNearestSelectableBodyAndLetsItGo) {
  EXPECT_EQ(events_of(two_boxes({0.1, 0, 0}, {0, 1, 1, 0})),
            (std::vector<std::string>{"stylus holds right", "stylus lets go of right"}));
}

TEST(Grasp, NothingIsTakenBeyondTheGraspDistance) {
  EXPECT_TRUE(events_of(two_boxes({0.2, 0, 0.3}, {1, 1, 1, 1})).empty());
}

TEST(Grasp, ATraceWithoutAButtonHoldsThroughout) {
  Scene scene = two_boxes({-0.1, 0, 0}, {1, 1});
  HapticSamples samples = still_with_button({-0.1, 0, 0}, {1, 1});
  samples.button.clear();
  scene.devices = {make_replay("stylus", samples)};
  EXPECT_EQ(events_of(std::move(scene)), std::vector<std::string>{"stylus holds left"});
}

TEST(Grasp, WhatIsNotSelectableIsNotTaken) {
  Scene scene = two_boxes({0.1, 0, 0}, {1, 1, 1});
  scene.bodies[1].selectable = false;
  EXPECT_TRUE(events_of(std::move(scene)).empty());
}

TEST(Grasp, TheHeldBodyKeepsItsPlaceInTheHand) {
  Scene scene;
  scene.parameters.duration = 1.5;
  BodyDescription box = scenes::body_of("box", scenes::centred_box({0.1, 0.1, 0.1}), 0.01);
  box.X_WB.position = {0.3, 0, 0};
  scene.bodies = {box};
  scene.devices = {scenes::hand_along({{0, 0, 0}, {0.1, 0.2, 0}}, 0.5)};
  scene.grasps = {{0, 0}};
  Simulation simulation(std::move(scene), {});
  while (simulation.frame() < simulation.frames_planned()) simulation.step();
  // The hand stood still for half a second, thirty time constants of the critically damped coupling of 20 g.
  EXPECT_LT((simulation.body_pose(0).position - Vector3d(0.4, 0.2, 0)).norm(), 1e-4);
}

}  // namespace
}  // namespace verisim::grasp_test
