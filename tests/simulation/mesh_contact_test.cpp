// contact = "fcl": the same loop over FCL's triangles. What it is there for (walls where the mesh has them, not where
// voxels do) and what does not act on it.
#include <gtest/gtest.h>

#include "tests/simulation/hybrid_scenes.hpp"

namespace verisim::mesh_contact_test {
namespace {

constexpr std::size_t kMoving = 1;

/// A box of 48 g that falls 30 mm onto a plate, a corner first.
Scene falling_box() {
  Scene scene;
  SimulationParameters& p = scene.parameters;
  p.contact = ContactMethod::fcl;
  p.hybrid = hybrid::off;
  p.all_bodies_are_dynamic = true;
  p.gravity = {0, 0, -9.81};
  p.duration = 2;
  BodyDescription plate = scenes::body_of("plate", *scenes::solid(Solid::Kind::box, {0.4, 0.4, 0.1}), 0.005);
  plate.fixed = true;
  BodyDescription box = scenes::body_of("box", *scenes::solid(Solid::Kind::box, {0.06, 0.04, 0.04}), 0.005);
  box.density = 500;
  box.X_WB = {{0.01, 0.02, 0.11}, rotation_from_vector({0.08, 0.16, 0.24})};
  scene.bodies = {std::move(plate), std::move(box)};
  return scene;
}

void run(Simulation& simulation) {
  while (simulation.frame() < simulation.frames_planned()) simulation.step();
}

TEST(MeshContact, LetsAFallenBoxComeToRestOnItsCorners) {
  Simulation simulation(falling_box(), {});
  run(simulation);
  const Pose rest = simulation.body_pose(kMoving);
  const double weight = 500 * 0.06 * 0.04 * 0.04 * 9.81;
  EXPECT_NEAR(simulation.body_force(kMoving).force.z(), weight, 1e-6 * weight);
  EXPECT_EQ(simulation.cost().contacts, 4U);
  EXPECT_NEAR(simulation.totals().penetration_max, 0, 0.001);
  EXPECT_NEAR(rest.position.z(), 0.05 + 0.02, 5e-5);  // voxels of 5 mm answer up to half a voxel away
}

TEST(MeshContact, IsTheSameInEveryRun) {
  Simulation one(falling_box(), {}), other(falling_box(), {});
  run(one);
  run(other);
  EXPECT_EQ(one.state_hash(), other.state_hash());
}

Scene pin_in_hole(Hybrid hybrid, ContactMethod contact) {
  Scene scene = scenes::brep_pin_in_hole(hybrid);
  scene.parameters.contact = contact;
  return scene;
}

TEST(MeshContact, LeavesHybridMethodsOutAndSaysSo) {
  Simulation exact(pin_in_hole(hybrid::exact, ContactMethod::fcl), {});
  ASSERT_EQ(exact.events().size(), 3U);
  EXPECT_EQ(exact.events()[1].kind, "device");
  EXPECT_EQ(exact.events().back().kind, "near");
  EXPECT_EQ(exact.events().front().text,
            "contact = \"fcl\" finds triangles, not voxels with faces: every contact is as with hybrid = \"off\"");
  Simulation off(pin_in_hole(hybrid::off, ContactMethod::fcl), {});
  ASSERT_EQ(off.events().size(), 2U);
  EXPECT_EQ(off.events().back().kind, "near");
  run(exact);
  run(off);
  EXPECT_GT(off.collision_frames(), 0U);
  EXPECT_EQ(exact.state_hash(), off.state_hash());
}

TEST(MeshContact, LeavesAllOfTheClearanceFree) {
  const auto contacts = [](ContactMethod method) {
    Scene scene = pin_in_hole(hybrid::off, method);
    scene.grasps.clear();
    scene.grasp_distance = 1e-9;
    scene.bodies[kMoving].X_WB = {{0.0045, 0.001, 0.06}, Quaterniond::Identity()};  // 0.39 mm from the wall
    Simulation simulation(scene, {});
    simulation.step();
    return simulation.cost().contacts;
  };
  EXPECT_GT(contacts(ContactMethod::voxmap), 0U);
  EXPECT_EQ(contacts(ContactMethod::fcl), 0U);
}

}  // namespace
}  // namespace verisim::mesh_contact_test
