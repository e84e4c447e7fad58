// The energy ledger closes in whole scenes: what is left over is rounding (dynamics/ledger.hpp).
#include <gtest/gtest.h>

#include <cmath>

#include "tests/simulation/hybrid_scenes.hpp"

namespace verisim::ledger_in_scenes_test {
namespace {

/// The largest residual of a run over the energy that went through it.
double worst_residual(Scene scene, double* contact_work) {
  Simulation simulation(std::move(scene), {});
  double residual = 0;
  double through = 0;
  while (simulation.frame() < simulation.frames_planned()) {
    simulation.step();
    const Simulation::Energy e = simulation.energy();
    residual = std::max(residual, std::abs(e.residual));
    through = std::max({through, std::abs(e.input), std::abs(e.gravity), e.kinetic});
    *contact_work = e.contact;
  }
  return residual / through;
}

// Sums of some ten thousand works of each at most the whole energy, each rounded a few times: under 1e-16 * 1e4 * 10.
constexpr double kRounding = 1e-11;

TEST(LedgerInScenes, ClosesWhileAHandPushesAPinIntoAHole) {
  for (const Integrator integrator : {Integrator::semi_implicit, Integrator::implicit}) {
    Scene scene = scenes::pin_in_hole();
    scene.parameters.integrator = integrator;
    double contact = 0;
    EXPECT_LT(worst_residual(std::move(scene), &contact), kRounding);
    EXPECT_NE(contact, 0);
  }
}

TEST(LedgerInScenes, ClosesWhileBoxesFall) {
  for (const Integrator integrator : {Integrator::semi_implicit, Integrator::implicit}) {
    double contact = 0;
    EXPECT_LT(worst_residual(scenes::falling_boxes(3, integrator), &contact), kRounding);
    EXPECT_GT(contact, 0) << "contacts take energy from what falls";
  }
}

/// The least that was lost up to any frame of a run [J]: below 0, energy came from nowhere.
double least_lost(Scene scene) {
  Simulation simulation(std::move(scene), {});
  double least = 0;
  while (simulation.frame() < simulation.frames_planned()) {
    simulation.step();
    const Simulation::Energy e = simulation.energy();
    least = std::min(least, e.dissipated + e.contact + e.numerical);
  }
  return least;
}

TEST(LedgerInScenes, ContactsThatAMethodChangedGiveNoEnergy) {
  for (const Integrator integrator : {Integrator::semi_implicit, Integrator::implicit})
    for (const Hybrid hybrid : {hybrid::restore, hybrid::blend, hybrid::exact}) {
      Scene scene = scenes::brep_pin_in_hole(hybrid);
      scene.parameters.integrator = integrator;
      EXPECT_GE(least_lost(std::move(scene)), -1e-12) << hybrid->name();
    }
}

// What the limit is there for: a voxel that a pin has just entered is a step deep at once.
TEST(LedgerInScenes, WithoutTheLimitVoxelsGiveEnergy) {
  Scene scene = scenes::brep_pin_in_hole(hybrid::restore);
  scene.parameters.integrator = Integrator::implicit;
  scene.parameters.passive_contacts = false;
  EXPECT_LT(least_lost(std::move(scene)), -1e-6);
}

}  // namespace
}  // namespace verisim::ledger_in_scenes_test
