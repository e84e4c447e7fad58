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

// A hand that turns by 4 rad at 2 rad/s, and a coupling too weak to turn the body along: past half a turn the shorter
// way is the other one.
TEST(Grasp, SaysThatTheCouplingTurnsRoundAtHalfATurn) {
  for (const double torque_max : {1e-6, 10.0}) {
    Scene scene;
    scene.parameters.duration = 2;
    scene.parameters.max_coupling_torque = torque_max;
    BodyDescription box = scenes::body_of("box", scenes::centred_box({0.1, 0.1, 0.1}), 0.01);
    scene.bodies = {box};
    HapticSamples samples;
    for (int i = 0; i <= 20; ++i) {
      samples.t.push_back(0.1 * i);
      samples.pose.push_back({Vector3d::Zero(), rotation_from_vector({0.2 * i, 0, 0})});
    }
    scene.devices = {make_replay("hand", std::move(samples))};
    scene.grasps = {{0, 0}};
    Simulation simulation(std::move(scene), {});
    while (simulation.frame() < simulation.frames_planned()) simulation.step();
    std::vector<double> times;
    for (const Event& event : simulation.events())
      if (event.kind == "coupling") times.push_back(event.time);
    if (torque_max == 10.0) {
      EXPECT_TRUE(times.empty());
      continue;
    }
    ASSERT_EQ(times.size(), 1U);
    // The body turns by half of torque / inertia t^2, 0.04 rad, meanwhile.
    EXPECT_NEAR(times[0], M_PI / 2, 0.05);
  }
}

}  // namespace
}  // namespace verisim::grasp_test
