// The audit of a run's energy, by runs whose energy is known: it finds what the contacts took, and what they created.
#include "engine/stability/ledger.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/stability/parts.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::stability::ledger_test {
namespace {

/// A box of 1 kg, 50 mm wide, `height` above a plate, or in it.
Scene falling(double height, bool passive) {
  Scene scene;
  scene.parameters.all_bodies_are_dynamic = true;
  scene.parameters.hybrid = hybrid::off;
  scene.parameters.gravity = {0, 0, -9.81};
  scene.parameters.passive_contacts = passive;
  scene.bodies = {box_body("plate", {0.2, 0.2, 0.04}, 1, 0.005), box_body("box", {0.05, 0.05, 0.05}, 1, 0.005)};
  scene.bodies[0].fixed = true;
  scene.bodies[0].X_WB.position.z() = -0.02;
  scene.bodies[1].X_WB.position.z() = 0.025 + height;
  return scene;
}

Row audited(const Scene& scene, int frames) {
  EnergyAudit audit(scene);
  Simulation simulation(scene, {});
  audit.start(simulation);
  for (int i = 0; i < frames; ++i) {
    simulation.step();
    simulation.clear_events();
    audit.look(simulation);
  }
  return audit.row("box", simulation);
}

// m g h, and the way that it sinks: less than a voxel.
TEST(EnergyAudit, FindsWhatContactsTookFromAFall) {
  const Row row = audited(falling(0.05, true), 2000);
  EXPECT_TRUE(row.holds) << row.why;
  EXPECT_GE(*row.figure("contact_recomputed"), 9.81 * 0.05 - test::tolerance(0.01));
  EXPECT_LE(*row.figure("contact_recomputed"), 9.81 * 0.055 + test::tolerance(0.01));
  EXPECT_LE(std::abs(*row.figure("contact_recomputed") - *row.figure("contact")), test::tolerance(1e-9));
  EXPECT_LE(std::abs(*row.figure("kinetic_recomputed") - *row.figure("kinetic")), test::tolerance(1e-12));
}

// A box that begins in the plate and is thrown out: what it has nobody gave.
TEST(EnergyAudit, FindsWhatContactsCreated) {
  Scene scene = falling(-0.008, false);
  scene.parameters.gravity.setZero();
  const Row row = audited(scene, 100);
  EXPECT_FALSE(row.holds);
  EXPECT_EQ(row.outcome, Outcome::diverged);
  EXPECT_NE(row.why.find("contacts create energy"), std::string::npos) << row.why;
  EXPECT_GT(*row.figure("created"), 1e-3);
}

}  // namespace
}  // namespace verisim::stability::ledger_test
