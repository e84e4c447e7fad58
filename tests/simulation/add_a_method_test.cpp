// The recipe of engine/simulation/README.md, "To add a hybrid method", followed to the letter: this file and its line
// in CMakeLists.txt are all that a method takes; a second line, in methods.cpp, would make it a word of scenarios.
#include <gtest/gtest.h>

#include "tests/simulation/hybrid_scenes.hpp"

namespace verisim::add_a_method_test {
namespace {

/// Leaves half of every force of explicit steps.
class HalfPair final : public PairMethod {
 public:
  void act_on_forces(ContactList& contacts, const Pose& /*X_AB*/) override {
    for (auto* column : {&contacts.fx, &contacts.fy, &contacts.fz}) halve(*column, contacts.size);
  }

 private:
  static void halve(std::vector<float>& column, std::uint32_t size) {
    for (std::uint32_t i = 0; i < size; ++i) column[i] *= 0.5F;
  }
};

class Half final : public HybridMethod {
 public:
  explicit Half(int precedence) : HybridMethod("half", precedence) {}
  [[nodiscard]] std::unique_ptr<PairMethod> make(const Pair& /*pair*/) const override {
    return std::make_unique<HalfPair>();
  }
};

/// The first contact of a pin that a hand pushes against the wall.
Vector3d first_force(Hybrid of_block, Hybrid of_pin, bool enabled = true) {
  Scene scene = scenes::brep_pin_in_hole(of_pin);
  scene.parameters.passive_contacts = false;  // the whole depth acts at once
  scene.bodies[0].hybrid = of_block;
  scene.bodies[0].hybrid_enabled = enabled;
  Simulation simulation(scene, {});
  while (simulation.body_contacts(1) == 0 && simulation.frame() < simulation.frames_planned()) simulation.step();
  EXPECT_GT(simulation.body_contacts(1), 0U);
  return simulation.body_force(1).force;
}

TEST(AMethod, ActsOnTheForcesOfItsPairs) {
  const Half half(5);
  const Vector3d off = first_force(hybrid::off, hybrid::off);
  EXPECT_LE((first_force(&half, &half) - 0.5 * off).norm(), 1e-6 * off.norm()) << "forces of contacts are floats";
}

TEST(AMethod, ActsWhereItsPrecedenceIsTheLower) {
  const Half before(5), behind(15);
  const Vector3d half = first_force(&before, &before);
  EXPECT_EQ(first_force(&before, hybrid::restore), half);
  EXPECT_EQ(first_force(hybrid::restore, &before), half);
  EXPECT_EQ(first_force(&behind, hybrid::restore), first_force(hybrid::restore, hybrid::restore));
  EXPECT_EQ(first_force(&before, hybrid::off), first_force(hybrid::off, hybrid::off));
}

TEST(AMethod, IsSwitchedOffLikeAnyOther) {
  const Half half(5);
  EXPECT_EQ(first_force(&half, &half, false), first_force(hybrid::off, hybrid::off));
}

// The words of a scenario come in the order of their precedence.
TEST(Methods, StandInTheOrderOfTheirPrecedence) {
  const auto all = hybrid::all();
  ASSERT_EQ(all.size(), 4U);
  for (std::size_t i = 1; i < all.size(); ++i) EXPECT_LT(all[i - 1]->precedence(), all[i]->precedence());
}

}  // namespace
}  // namespace verisim::add_a_method_test
