// What a simulation does that physics does not is an event: a body that jumps over others, contacts that give energy
// which nobody gave them (stages/tunnelling.hpp, stages/pair_energy.hpp).
#include <gtest/gtest.h>

#include <cmath>

#include "tests/simulation/hybrid_scenes.hpp"

namespace verisim::blown_up_test {
namespace {

/// The events of a kind in a whole run.
std::vector<Event> events_of(const Scene& scene, const std::string& kind) {
  Simulation simulation(scene, {});
  std::vector<Event> found;
  while (simulation.frame() < simulation.frames_planned()) {
    simulation.step();
    for (const Event& event : simulation.events())
      if (event.kind == kind) found.push_back(event);
    simulation.clear_events();
  }
  return found;
}

/// Two boxes of 60 mm that fly freely along x and across.
Scene flying(const Vector3d& v) {
  Scene scene = scenes::falling_boxes(2, Integrator::semi_implicit);
  scene.parameters.gravity = Vector3d::Zero();
  scene.parameters.duration = 0.02;
  for (std::size_t i : {1U, 2U}) {
    scene.bodies[i].X_WB.position = {0, 3.0 * static_cast<double>(i), 5};
    scene.bodies[i].twist.linear = v;
  }
  return scene;
}

// 0.06 m / 1 ms = 60 m/s along an edge; along the diagonal of a face the box is 0.06 sqrt(2) m thick, as its shadow is.
TEST(Tunnelling, IsToldOncePerBodyThatMovesFartherThanItIsThick) {
  EXPECT_TRUE(events_of(flying({59.9, 0, 0}), "tunnelling").empty());
  EXPECT_TRUE(events_of(flying({0, 0, -59.9}), "tunnelling").empty());
  EXPECT_TRUE(events_of(flying({59.9, 59.9, 0}), "tunnelling").empty());
  EXPECT_EQ(events_of(flying({60.1, 60.1, 0}), "tunnelling").size(), 2U);
  const std::vector<Event> told = events_of(flying({60.1, 0, 0}), "tunnelling");
  ASSERT_EQ(told.size(), 2U);
  EXPECT_EQ(told[0].time, 0) << "in the first frame in which it does";
  EXPECT_EQ(
      told[0].text,
      "'box0' moves farther in a step (0.0601 m) than it is thick (0.06 m): it may pass through others unseen; use a "
      "smaller timestep");
  EXPECT_NE(told[1].text.find("'box1'"), std::string::npos);
}

TEST(Tunnelling, HasToDoWithTheStep) {
  Scene scene = flying({100, 0, 0});
  scene.parameters.timestep = 0.0005;
  EXPECT_TRUE(events_of(scene, "tunnelling").empty());
  scene.parameters.timestep = 0.002;
  EXPECT_EQ(events_of(scene, "tunnelling").size(), 2U);
}

TEST(Tunnelling, IsNotOfWhatOnlySpins) {
  Scene scene = flying({0, 0, 0});
  scene.bodies[1].twist.angular = {0, 0, 1e5};
  EXPECT_TRUE(events_of(scene, "tunnelling").empty());
}

// The plate is 20 mm thick. Voxels push what has passed its middle out on the other side.
TEST(Tunnelling, IsToldOfWhatIsThinForTheSpeedOfOthers) {
  const auto told = [](double speed) {
    Scene scene = scenes::falling_boxes(1, Integrator::implicit);
    scene.parameters.gravity = Vector3d::Zero();
    scene.parameters.duration = 0.005;
    scene.bodies[1].twist.linear = {0, 0, -speed};
    return events_of(scene, "tunnelling");
  };
  EXPECT_TRUE(told(9.9).empty());
  ASSERT_EQ(told(10.1).size(), 1U);
  EXPECT_EQ(
      told(10.1)[0].text,
      "'box0' moves 0.0101 m in a step to 'plate', which is 0.02 m thick there: its voxels may let it pass; use a "
      "smaller timestep, or hybrid = \"exact\"");
}

/// A box on a plate that begins `depth` inside of it, in peace: what pushes it out comes from nowhere.
Scene overlapping(double depth, Integrator integrator) {
  Scene scene = scenes::falling_boxes(1, integrator);
  scene.bodies[1].X_WB.position = {0, 0, 0.04 - depth};
  scene.parameters.duration = 0.1;
  scene.parameters.passive_contacts = false;
  return scene;
}

TEST(CreatedEnergy, IsToldOnceWithThePair) {
  for (const Integrator integrator : {Integrator::semi_implicit, Integrator::implicit}) {
    const std::vector<Event> told = events_of(overlapping(0.008, integrator), "energy");
    ASSERT_EQ(told.size(), 1U);
    EXPECT_NE(told[0].text.find("contacts of 'plate' and 'box0' gave "), std::string::npos) << told[0].text;
    EXPECT_LE(told[0].text.size(), 223U) << "a run file keeps no more of it";
  }
}

// The same with springs that begin where contacts begin: it stays where it was put.
TEST(CreatedEnergy, IsNotOfSpringsThatBeginWhereContactsBegin) {
  for (const Integrator integrator : {Integrator::semi_implicit, Integrator::implicit}) {
    Scene scene = overlapping(0.008, integrator);
    scene.parameters.passive_contacts = true;
    EXPECT_TRUE(events_of(scene, "energy").empty());
    Simulation simulation(scene, {});
    const double start = simulation.body_pose(1).position.z();
    while (simulation.frame() < simulation.frames_planned()) simulation.step();
    EXPECT_LE(std::abs(simulation.body_pose(1).position.z() - start), 1e-3);
  }
}

// A voxel contact that begins deep in one step: fast against a hard surface, without damping.
TEST(CreatedEnergy, IsToldOfAVoxelThatIsEnteredAtOnce) {
  Scene scene = scenes::brep_pin_in_hole(hybrid::off);
  scene.parameters.contact_damping_ratio = 0;
  scene.parameters.passive_contacts = false;
  EXPECT_EQ(events_of(scene, "energy").size(), 1U);
  scene.parameters.passive_contacts = true;
  scene.devices = {scenes::hand_of_brep_pin()};  // a hand remembers
  EXPECT_TRUE(events_of(scene, "energy").empty()) << "springs begin where contacts begin";
}

// Springs that give back what they were given create nothing: a box that falls, is thrown back and falls again.
TEST(CreatedEnergy, IsNotWhatAContactGivesBack) {
  Scene scene = scenes::falling_boxes(1, Integrator::implicit);
  scene.parameters.contact_stiffness = 100;  // per voxel; a bounce takes many steps
  scene.parameters.duration = 0.5;
  EXPECT_TRUE(events_of(scene, "energy").empty());
}

TEST(CreatedEnergy, IsNotInScenesWhoseContactsArePassive) {
  for (const Integrator integrator : {Integrator::semi_implicit, Integrator::implicit})
    EXPECT_TRUE(events_of(scenes::falling_boxes(1, integrator), "energy").empty());
  EXPECT_TRUE(events_of(scenes::brep_pin_in_hole(hybrid::exact), "energy").empty());
  Scene apart = scenes::falling_boxes(2, Integrator::semi_implicit);
  apart.parameters.gravity = Vector3d::Zero();
  EXPECT_TRUE(events_of(apart, "energy").empty());
}

}  // namespace
}  // namespace verisim::blown_up_test
