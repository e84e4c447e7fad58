// What acts on one body acts back on the other, and what is written down is what acted.
#include <gtest/gtest.h>

#include "tests/simulation/hybrid_scenes.hpp"
#include "tests/simulation/link_wrench.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::reaction_test {
namespace {

using test::link_wrench;
using test::tolerance;

/// One box flies past the middle of another: both turn.
Scene two_free_boxes(Hybrid hybrid) {
  static const BodyDescription box = scenes::body_of("a", *scenes::solid(Solid::Kind::box, {0.1, 0.1, 0.1}), 0.005);
  Scene scene;
  scene.parameters.hybrid = hybrid;
  scene.parameters.all_bodies_are_dynamic = true;
  scene.parameters.duration = 0.5;
  scene.bodies = {box, box};
  scene.bodies[1].name = "b";
  scene.bodies[0].twist.linear = {0.2, 0.05, 0};
  scene.bodies[1].X_WB.position = {0.12, 0.03, 0};
  return scene;
}

class EveryMethod : public testing::TestWithParam<Hybrid> {};
INSTANTIATE_TEST_SUITE_P(Hybrid, EveryMethod,
                         testing::Values(hybrid::off, hybrid::restore, hybrid::blend, hybrid::exact));

TEST_P(EveryMethod, KeepsTheMomentumOfTwoFreeBodies) {
  Simulation simulation(two_free_boxes(GetParam()), {});
  const double mass = simulation.mass(0);
  const auto momentum = [&] {
    return Vector3d(mass * (simulation.body_twist(0).linear + simulation.body_twist(1).linear));
  };
  const Vector3d before = momentum();
  const Vector3d first_before = simulation.body_twist(0).linear;
  while (simulation.frame() < simulation.frames_planned()) {
    simulation.step();
    const Vector3d sum = simulation.body_force(0).force + simulation.body_force(1).force;
    ASSERT_LE(sum.norm(), tolerance(1e-9 * simulation.body_force(0).force.norm()));
  }
  EXPECT_GT((simulation.body_twist(0).linear - first_before).norm(), 0.05) << "they have met";
  EXPECT_LE((momentum() - before).norm(), tolerance(1e-9 * before.norm()));
  EXPECT_GE(simulation.energy().contact, -1e-12);
}

TEST_P(EveryMethod, TellsOfALinkAndOfAFixedBodyWhatActedOnTheOneThatMoves) {
  for (const Integrator integrator : {Integrator::semi_implicit, Integrator::implicit}) {
    Scene scene = scenes::brep_pin_in_hole(GetParam());
    scene.parameters.integrator = integrator;
    Simulation simulation(std::move(scene), {});
    double most = 0;
    while (simulation.frame() < simulation.frames_planned()) {
      simulation.step();
      const Wrench on_block = simulation.body_force(0);
      const Wrench on_pin = simulation.body_force(1);
      const double size = on_pin.force.norm();
      most = std::max(most, size);
      ASSERT_LE((on_block.force + on_pin.force).norm(), tolerance(1e-9 * (1 + size))) << simulation.frame();
      const Wrench link = link_wrench(simulation);
      ASSERT_LE((link.force - on_pin.force).norm(), tolerance(1e-9 * (1 + size))) << simulation.frame();
      ASSERT_LE((link.torque - on_pin.torque).norm(), tolerance(1e-9 * (1 + size))) << simulation.frame();
    }
    EXPECT_GT(most, 0.1);
    EXPECT_EQ(simulation.totals().force_max, most);
  }
}

/// The voxels answer before the precise surfaces do, and at once with a depth: they must not throw the pin out.
TEST(SwitchingExactOff, GivesNoEnergy) {
  Scene scene;
  scene.parameters.hybrid = hybrid::exact;
  scene.parameters.duration = 1;
  scene.bodies = {scenes::body_of("block",
                                  scenes::difference(scenes::solid(Solid::Kind::box, {0.2, 0.2, 0.1}),
                                                     scenes::solid(Solid::Kind::cylinder, {0.03, 0.2})),
                                  0.003),
                  scenes::body_of("pin", *scenes::solid(Solid::Kind::cylinder, {0.028, 0.15}), 0.003)};
  scene.bodies[0].fixed = true;
  scene.bodies[1].X_WB.position = {0, 0, 0.08};
  scene.devices = {scenes::hand_along({{0, 0, 0.08}, {0.005, 0.004, 0}}, 0.2)};
  scene.grasps = {{0, 1}};
  Simulation simulation(std::move(scene), {});
  double least = 0;
  bool on = true;
  std::uint64_t contacts = 0;
  while (simulation.frame() < simulation.frames_planned()) {
    if (simulation.frame() % 5 == 4) simulation.set_hybrid_enabled(1, on = !on);
    simulation.step();
    contacts += on ? 0 : simulation.body_contacts(1);
    const Simulation::Energy e = simulation.energy();
    least = std::min(least, e.dissipated + e.contact + e.numerical);
  }
  EXPECT_GT(contacts, 100U) << "the voxels touched";
  EXPECT_GE(least, -1e-12);
}

TEST(ConstraintFrames, CountAFrameOnceHoweverManyLinksAreHeld) {
  Scene scene = scenes::brep_pin_in_hole(hybrid::restore);
  scene.devices.clear();
  scene.grasps.clear();
  scene.parameters.duration = 0.02;
  scene.bodies[1].X_WB.position = {0.0045, 0.001, 0.06};
  scene.bodies.push_back(scene.bodies[1]);
  scene.bodies.push_back(scene.bodies[0]);
  scene.bodies[2].name = "second pin";
  scene.bodies[3].name = "second block";
  for (const std::size_t i : {2U, 3U}) scene.bodies[i].X_WB.position.x() += 1;
  scene.parameters.all_bodies_are_dynamic = true;
  Simulation simulation(std::move(scene), {});
  while (simulation.frame() < simulation.frames_planned()) simulation.step();
  const auto frames = simulation.totals().constraint_frames[static_cast<std::size_t>(ConstraintKind::cylindrical)];
  EXPECT_GT(2 * frames, simulation.frame()) << "counted twice, it would not be seen below";
  EXPECT_LE(frames, simulation.frame());
}

}  // namespace
}  // namespace verisim::reaction_test
