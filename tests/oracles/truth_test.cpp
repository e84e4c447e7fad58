// What 'verisim tradeoff' calls the truth (hybrid = "exact" at a fine step), held against what needs no simulation: the
// force of a spring behind a plane and behind the wall of a hole, overlaps by formula and by dense sampling, and the
// same motion at finer steps.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/ruler/ruler.hpp"
#include "engine/tradeoff/errors.hpp"
#include "tests/simulation/hybrid_scenes.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::truth_test {
namespace {

using test::tolerance;

constexpr double kStiffness = 300;                                          // N/m, of the virtual coupling
constexpr double kHole = 0.075, kPin = 0.07, kHeight = 0.1, kLength = 0.2;  // m

/// The handle goes from one place to the next in `seconds` each, and stays at the last.
std::shared_ptr<Device> driven(const std::vector<Vector3d>& places, double seconds) {
  HapticSamples samples;
  for (std::size_t i = 0; i < places.size(); ++i) {
    samples.t.push_back(seconds * static_cast<double>(i));
    samples.pose.push_back({places[i], Quaterniond::Identity()});
  }
  return make_replay("hand", std::move(samples));
}

Scene exact_scene(Scene scene, double timestep, std::shared_ptr<Device> hand, double duration) {
  scene.parameters.hybrid = hybrid::exact;
  scene.parameters.integrator = Integrator::implicit;
  scene.parameters.timestep = timestep;
  scene.parameters.max_stiffness = kStiffness;
  scene.parameters.duration = duration;
  scene.devices = {std::move(hand)};
  return scene;
}

struct Found {
  tradeoff::Motion motion;
  Wrench last;
};

Found play(Scene scene) {
  Simulation simulation(std::move(scene), {});
  tradeoff::WindowMeans means;
  while (simulation.frame() < simulation.frames_planned()) {
    simulation.prepare();
    simulation.step();
    simulation.clear_events();
    const Wrench wrench = simulation.body_force(1);
    Vector6d both;
    both << wrench.force, wrench.torque;
    means.add(std::max(0.0, simulation.time() - simulation.dt()), simulation.time(), both);
  }
  Found found;
  found.motion.bodies.push_back({"held", means.means(), simulation.body_pose(1)});
  found.last = simulation.body_force(1);
  return found;
}

Scene pin_at_rest() {
  Scene scene = scenes::brep_pin_in_hole(hybrid::exact);
  scene.bodies[1].X_WB.position = Vector3d::Zero();
  return scene;
}

// A hand that holds a pin d beyond the wall of its hole, through a spring, feels k d along the normal and nothing else;
// the pin stands at the clearance.
TEST(Truth, IsTheSpringBehindTheWallOfAHole) {
  for (const double beyond : {0.001, 0.003}) {
    const double x = kHole - kPin + beyond;
    const Found found = play(exact_scene(pin_at_rest(), 0.0005, driven({{0, 0, 0}, {x, 0, 0}}, 0.2), 1.5));
    EXPECT_NEAR(found.last.force.x(), -kStiffness * beyond, tolerance(1e-6));
    EXPECT_NEAR(found.last.force.y(), 0, tolerance(1e-6));
    EXPECT_NEAR(found.last.force.z(), 0, tolerance(1e-6));
    EXPECT_NEAR(found.motion.bodies[0].end.position.x(), kHole - kPin, tolerance(1e-8));
  }
}

// The same behind a plane: a box of 40 mm, pressed d deep into a plate of 20 mm.
TEST(Truth, IsTheSpringBehindAPlane) {
  Scene scene;
  BodyDescription plate = scenes::body_of("plate", *scenes::solid(Solid::Kind::box, {0.2, 0.2, 0.02}), 0.005);
  plate.fixed = true;
  BodyDescription box = scenes::body_of("box", *scenes::solid(Solid::Kind::box, {0.04, 0.04, 0.04}), 0.005);
  box.X_WB.position = {0, 0, 0.035};
  scene.bodies = {plate, box};
  scene.grasps = {{0, 1}};
  const double deep = 0.004;
  const Found found = play(exact_scene(scene, 0.0005, driven({{0, 0, 0.035}, {0, 0, 0.03 - deep}}, 0.2), 1.5));
  EXPECT_NEAR(found.last.force.z(), kStiffness * deep, tolerance(1e-6));
  EXPECT_NEAR(found.last.torque.norm(), 0, tolerance(1e-7));
  EXPECT_NEAR(found.motion.bodies[0].end.position.z(), 0.03, tolerance(1e-8));
}

/// How deep a point is in the block with its hole [m]; 0 outside. Its walls alone: no other face is nearer here.
double depth_in_block(const Vector3d& p) {
  const double from_hole = std::hypot(p.x(), p.y()) - kHole, from_faces = kHeight / 2 - std::abs(p.z());
  return std::max(0.0, std::min(from_hole, from_faces));
}

/// The same for the pin.
double depth_in_pin(const Vector3d& p) {
  return std::max(0.0, std::min(kPin - std::hypot(p.x(), p.y()), kLength / 2 - std::abs(p.z())));
}

/// Deepest of either's surface in the other, by a sample every so many m. Never too large.
double sampled_overlap(const Pose& X_WP, double spacing) {
  double deepest = 0;
  const auto around = static_cast<int>(std::ceil(2 * 3.14159265358979 * kHole / spacing));
  const auto look = [&](double radius, double height, const auto& depth) {
    const auto along = static_cast<int>(std::ceil(height / spacing));
    for (int i = 0; i <= along; ++i)
      for (int k = 0; k < around; ++k) {
        const double angle = 2 * 3.14159265358979 * k / around;
        deepest = std::max(deepest, depth({radius * std::cos(angle), radius * std::sin(angle),
                                           height * (static_cast<double>(i) / along - 0.5)}));
      }
  };
  look(kPin, kLength, [&](const Vector3d& p) { return depth_in_block(X_WP * p); });
  look(kHole, kHeight, [&](const Vector3d& p) { return depth_in_pin(X_WP.inverse() * p); });
  return deepest;
}

// The ruler, which judges overlaps, against a formula: a pin d beyond the clearance overlaps by d.
// Against dense samples where there is none: tilted pins. Samples of 0.5 mm miss at most what a surface of slope 1
// changes within half a diagonal of them; they are never above the truth.
TEST(Truth, HasItsOverlapFromARulerThatFormulaAndSamplesConfirm) {
  const ruler::Shape block(
      std::vector<ruler::PartData>{{"block", "difference(box(0.375,0.375,0.1),cylinder(0.075,0.1))", {}}});
  const ruler::Shape pin(std::vector<ruler::PartData>{{"pin", "cylinder(0.07,0.2)", {}}});
  const ruler::Accuracy fine{.absolute = 1e-7, .relative = 1e-3, .pieces_max = 60'000};
  for (const double d : {-0.001, 1e-5, 1e-4, 1e-3, 4e-3}) {
    const ruler::Overlap found =
        ruler::overlap(pin, {{kHole - kPin + d, 0, 0}, Quaterniond::Identity()}, block, {}, fine);
    EXPECT_LE(found.depth, std::max(0.0, d) + 1e-12);
    EXPECT_GE(found.depth + found.bound, std::max(0.0, d) - 1e-12);
    EXPECT_LE(found.bound, 1e-6 + 1e-3 * std::abs(d));
  }
  constexpr double kSpacing = 0.0005;
  for (const double tilt : {0.02, 0.06, 0.12})
    for (const double aside : {0.0, 0.004, 0.007}) {
      const Pose X_WP{{aside, 0.001, 0.02}, rotation_from_vector({0.3 * tilt, tilt, 0})};
      const ruler::Overlap found = ruler::overlap(pin, X_WP, block, {}, fine);
      const double sampled = sampled_overlap(X_WP, kSpacing);
      EXPECT_GE(found.depth + found.bound, sampled) << tilt << ' ' << aside;
      EXPECT_LE(found.depth, sampled + kSpacing) << tilt << ' ' << aside;
    }
}

// A hand brings the pin against the wall and along it: the force over windows of 10 ms at steps of 2, 1, 1/2 ms has an
// order, and the error that Richardson's rule then gives the finest holds against a step eight times finer.
TEST(Truth, ConvergesInTheStepAndSaysHowFarItIs) {
  const auto hand = [] {
    return driven({{0, 0, 0}, {0.006, 0, 0}, {0.007, 0.003, 0.01}, {0.006, 0.004, 0.03}, {0, 0.008, 0.03}}, 0.1);
  };
  const auto at = [&](double step) { return play(exact_scene(pin_at_rest(), step, hand(), 0.5)).motion; };
  const tradeoff::Motion coarse = at(0.001), middle = at(0.0005), fine = at(0.00025), truth = at(0.25e-3 / 8);
  const tradeoff::Convergence c =
      tradeoff::convergence_of(tradeoff::force_difference(coarse, middle), tradeoff::force_difference(middle, fine), 2);
  EXPECT_TRUE(c.converges) << "order " << c.order;
  EXPECT_GT(c.order, 0.7);
  EXPECT_LT(c.order, 2.5);
  const double off = tradeoff::force_difference(fine, truth);
  EXPECT_LT(off, 2 * c.error);
  EXPECT_GT(off, 0.3 * c.error);
}

}  // namespace
}  // namespace verisim::truth_test
