// The method of a scenario that names none: `exact` where it can act, with its integrator; else `restore`, and an event
// says why.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine/exact/convex_step.hpp"
#include "tests/simulation/hybrid_scenes.hpp"

namespace verisim::default_method_test {
namespace {

Scene nothing_named() {
  Scene scene = scenes::brep_pin_in_hole(hybrid::restore);
  scene.parameters.hybrid_by_default = scene.parameters.integrator_by_default = true;
  return scene;
}

/// What the scene says of its method before the first frame, and whether its steps are implicit.
struct Chosen {
  explicit Chosen(const Scene& scene) {
    Simulation simulation(scene, {});
    for (const Event& event : simulation.events())
      if (event.kind == "hybrid") texts.push_back(event.text);
    simulation.step();
    while (simulation.body_contacts(1) == 0 && simulation.frame() < simulation.frames_planned()) simulation.step();
    for (const auto& answers : simulation.answers()) method = answers.method;
  }
  std::vector<std::string> texts;
  std::string method;
};

TEST(DefaultMethod, IsExactWhereItCanAct) {
  const Chosen chosen(nothing_named());
  EXPECT_TRUE(chosen.texts.empty());
  EXPECT_EQ(chosen.method, "exact");
}

TEST(DefaultMethod, IsWhatTheSceneNames) {
  for (const Hybrid method : {hybrid::restore, hybrid::exact}) {
    Scene scene = nothing_named();
    scene.parameters.hybrid = method;
    scene.parameters.hybrid_by_default = false;
    EXPECT_EQ(Chosen(scene).method, method->name());
  }
}

/// @param reason  a part of it
void expect_restore(const Scene& scene, const std::string& reason) {
  const Chosen chosen(scene);
  EXPECT_EQ(chosen.method, "restore");
  ASSERT_FALSE(chosen.texts.empty()) << reason;
  EXPECT_NE(chosen.texts[0].find("no method was named: 'restore' acts, not 'exact': "), std::string::npos);
  EXPECT_NE(chosen.texts[0].find(reason), std::string::npos) << chosen.texts[0];
}

TEST(DefaultMethod, IsRestoreWhereTheIntegratorIsNamed) {
  Scene scene = nothing_named();
  scene.parameters.integrator_by_default = false;
  expect_restore(scene, "integrator = \"semi-implicit\" was asked for");
  scene.devices = {scenes::hand_of_brep_pin()};  // a hand remembers
  scene.parameters.integrator = Integrator::implicit;
  EXPECT_EQ(Chosen(scene).method, "exact");
}

TEST(DefaultMethod, IsRestoreWhereAFaceIsNotKnown) {
  Scene scene = nothing_named();
  for (Face& face : scene.bodies[0].parts[0].faces) face.surface = OtherSurface{};
  expect_restore(scene, "fewer than two bodies have faces that 'exact' knows");
}

}  // namespace
}  // namespace verisim::default_method_test
