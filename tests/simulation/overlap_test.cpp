// Bodies that begin inside of each other, or are put there, part under exact contact without being thrown: judged from
// velocities and events.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/simulation/hybrid_scenes.hpp"
#include "tests/support/random_inputs.hpp"

namespace verisim::overlap_test {
namespace {

using verisim::test::Inputs;
using verisim::test::seeds;

constexpr std::size_t kBox = 1;
/// m/s: as fast as contacts push apart what began inside (ConvexStep::kPushOut).
constexpr double kPushOut = 0.5;

struct Found {
  double fastest = 0;  ///< m/s
  std::vector<Event> overlaps;
  bool sinks = false;
};

Found run(Simulation& simulation) {
  Found found;
  while (simulation.frame() < simulation.frames_planned()) {
    simulation.step();
    found.fastest = std::max(found.fastest, simulation.body_twist(kBox).linear.norm());
    for (const Event& event : simulation.events()) {
      if (event.kind == "overlap") found.overlaps.push_back(event);
      found.sinks = found.sinks || event.kind == "sinking";
    }
    simulation.clear_events();
  }
  return found;
}

/// A cube over a fixed plate, with its lowest point `depth` edges below the plate's face.
Scene cube_in_plate(double size, double depth, const Quaterniond& turned, double dt) {
  Scene scene;
  scene.parameters.hybrid = hybrid::exact;
  scene.parameters.integrator = Integrator::implicit;
  scene.parameters.all_bodies_are_dynamic = true;
  scene.parameters.timestep = dt;
  scene.parameters.duration = 200 * dt;
  const double voxel = size / 20;
  scene.bodies.push_back(scenes::body_of("plate", *scenes::solid(Solid::Kind::box, {3 * size, 3 * size, size}), voxel));
  scene.bodies.push_back(scenes::body_of("box", *scenes::solid(Solid::Kind::box, {size, size, size}), voxel));
  scene.bodies[0].fixed = true;
  scene.bodies[0].X_WB.position = {0, 0, -size / 2};
  scene.bodies[kBox].density = 1000;
  const double reach = 0.5 * size * turned.toRotationMatrix().row(2).cwiseAbs().sum();
  scene.bodies[kBox].X_WB = {{0, 0, reach - depth * size}, turned};
  return scene;
}

// Unmended, a row as deep as a voxel ended in one step: voxel / dt, 2.4 m/s at 50 mm and 1 ms, 24 m/s at 0.1 ms.
TEST(Overlap, AtTheBeginningThrowsNobody) {
  for (const std::uint64_t seed : seeds(12)) {
    Inputs in(seed);
    const double size = std::pow(10, in.between(-2.5, -0.5)), depth = std::pow(10, in.between(-2, -0.3));
    const double dt = in.between(0, 1) < 0.5 ? 1e-3 : 1e-4;
    Quaterniond turned = Quaterniond::Identity();
    if (in.between(0, 1) < 0.5) turned = in.rotation();
    Scene scene = cube_in_plate(size, depth, turned, dt);
    scene.parameters.restitution = in.between(0, 1) < 0.5 ? 0 : 0.5;
    SCOPED_TRACE(testing::Message() << "seed " << seed << ": " << size << " m, " << depth << " edges, " << dt << " s");
    Simulation simulation(std::move(scene), {});
    const Found found = run(simulation);
    EXPECT_LE(found.fastest, kPushOut);
    ASSERT_EQ(found.overlaps.size(), 1U);
    EXPECT_NE(found.overlaps[0].text.find("'plate' and 'box' were put inside"), std::string::npos)
        << found.overlaps[0].text;
  }
}

TEST(Overlap, ByASetPoseIsLikeOneAtTheBeginning) {
  Scene scene = cube_in_plate(0.05, -1, Quaterniond::Identity(), 1e-3);
  const Pose inside{{0, 0, 0.02}, Quaterniond::Identity()};
  Simulation simulation(std::move(scene), {});
  for (int i = 0; i < 150; ++i) simulation.step();
  EXPECT_TRUE(simulation.events().empty() || simulation.events().back().kind != "overlap");
  simulation.set_body_pose(kBox, inside);
  const Found found = run(simulation);
  EXPECT_LE(found.fastest, kPushOut);
  ASSERT_EQ(found.overlaps.size(), 1U);
  EXPECT_NE(found.overlaps[0].text.find("were put inside"), std::string::npos) << found.overlaps[0].text;
}

/// How deep the surface of a cube reaches into the plate of cube_in_plate(size, …) [m]; <= 0: it does not.
double depth_of_cube(const Pose& X_WB, double edge, double size) {
  double depth = -1;
  constexpr int kSteps = 40;
  for (int i = 0; i <= kSteps; ++i)
    for (int j = 0; j <= kSteps; ++j)
      for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-0.5, 0.5}) {
          Vector3d p;
          p[axis] = side;
          p[(axis + 1) % 3] = static_cast<double>(i) / kSteps - 0.5;
          p[(axis + 2) % 3] = static_cast<double>(j) / kSteps - 0.5;
          const Vector3d q = X_WB * Vector3d(edge * p);
          const Vector3d within(1.5 * size - std::abs(q.x()), 1.5 * size - std::abs(q.y()),
                                0.5 * size - std::abs(q.z() + 0.5 * size));
          depth = std::max(depth, within.minCoeff());
        }
  return depth;
}

// A row is of features as near as a voxel. What lay deeper was told when it had fallen as far as the plate's other
// side, and a cube that kept its place never.
TEST(Overlap, WithNoFeatureNearAnotherIsToldAtTheBeginning) {
  int deep = 0;
  for (const std::uint64_t seed : seeds(24)) {
    Inputs in(seed);
    const double size = std::pow(10, in.between(-2.5, -0.5)), small = size * in.between(0.2, 0.8);
    Scene scene = cube_in_plate(size, -3, Quaterniond::Identity(), 1e-3);
    scene.bodies[kBox] = scenes::body_of("box", *scenes::solid(Solid::Kind::box, {small, small, small}), size / 20);
    scene.bodies[kBox].X_WB = {
        {in.between(-1.6, 1.6) * size, in.between(-1.6, 1.6) * size, in.between(-1.2, 0.6) * size}, in.rotation()};
    const double depth = depth_of_cube(scene.bodies[kBox].X_WB, small, size);
    SCOPED_TRACE(testing::Message() << "seed " << seed << ": " << depth << " m, edge " << small);
    Simulation simulation(std::move(scene), {});
    std::vector<Event> overlaps;
    for (const Event& event : simulation.events())
      if (event.kind == "overlap") overlaps.push_back(event);
    const double voxel = size / 20;
    EXPECT_TRUE(depth > 0 || overlaps.empty()) << (overlaps.empty() ? "" : overlaps[0].text);
    if (depth < 4 * voxel) continue;
    ++deep;
    ASSERT_EQ(overlaps.size(), 1U);
    double told = 0;
    ASSERT_EQ(
        std::sscanf(overlaps[0].text.c_str(), "'plate' and 'box' were put inside of each other, by %lf mm", &told), 1);
    EXPECT_LE(1e-3 * told, depth + voxel / 2);  // samples stand apart
    EXPECT_GE(1e-3 * told, std::min(depth, 6 * voxel) - 3 * voxel);
  }
  EXPECT_GE(deep, 5);
}

TEST(Overlap, WithNoFeatureNearAnotherIsToldAfterASetPose) {
  Scene scene = cube_in_plate(0.05, -1, Quaterniond::Identity(), 1e-3);
  scene.bodies[kBox] = scenes::body_of("box", *scenes::solid(Solid::Kind::sphere, {0.01}), 0.0025);
  scene.bodies[kBox].X_WB.position.z() = 0.011;
  Simulation simulation(std::move(scene), {});
  simulation.step();
  simulation.prepare();
  EXPECT_TRUE(simulation.events().empty() || simulation.events().back().kind != "overlap");
  simulation.set_body_pose(kBox, {{0, 0, -0.025}, Quaterniond::Identity()});
  simulation.prepare();
  ASSERT_FALSE(simulation.events().empty());
  EXPECT_EQ(simulation.events().back().kind, "overlap");
}

TEST(Overlap, IsNotToldOfWhatTouches) {
  Scene scene = cube_in_plate(0.05, 0, Quaterniond::Identity(), 1e-3);
  scene.parameters.gravity = {0, 0, -9.81};
  Simulation simulation(std::move(scene), {});
  const Found found = run(simulation);
  EXPECT_TRUE(found.overlaps.empty());
  EXPECT_LE(found.fastest, 1e-6);
}

// Flush sides say nothing of how deep a box is pressed into the one below: unmended, deeper than 1 um + its way in a
// step it had no contact any more, and fell through.
TEST(Overlap, OfAHeavyBoxFlushWithTheOneBelowIsWhatItsSpringsSay) {
  for (const double load : {1e3, 1e5, 3e5}) {  // N
    Scene scene = cube_in_plate(0.05, 0, Quaterniond::Identity(), 1e-3);
    scene.bodies[0].parts = scene.bodies[kBox].parts;  // of one size
    scene.bodies[0].X_WB.position.z() = -0.025;
    scene.bodies[kBox].density = load / 9.81 / (0.05 * 0.05 * 0.05);
    scene.parameters.gravity = {0, 0, -9.81};
    Simulation simulation(std::move(scene), {});
    (void)run(simulation);
    // Put on it at once: no deeper than twice what four edges of steel give way.
    const double deepest = 2 * load / (SimulationParameters().exact_stiffness * 4 * 0.05);
    EXPECT_GE(simulation.body_pose(kBox).position.z(), 0.025 - deepest) << load << " N";
  }
}

// Its weight holds it on the plate as it comes out; that is not sinking.
TEST(Overlap, IsNoSinking) {
  Scene scene = cube_in_plate(0.05, 0.3, Quaterniond::Identity(), 1e-3);
  scene.parameters.gravity = {0, 0, -9.81};
  Simulation simulation(std::move(scene), {});
  const Found found = run(simulation);
  EXPECT_FALSE(found.sinks);
  EXPECT_EQ(found.overlaps.size(), 1U);
  EXPECT_NEAR(simulation.body_pose(kBox).position.z(), 0.025, 1e-3);
}

/// A pin in the bore of a free tube, its head in the tube's wall, where no face is within a voxel. Without gravity.
Scene head_in_wall(Inputs& in, double dt) {
  Scene scene = cube_in_plate(0.1, 0, Quaterniond::Identity(), dt);
  scene.parameters.duration = 0.4;
  const auto cylinder = [](double radius, double height) {
    return scenes::solid(Solid::Kind::cylinder, {radius, height});
  };
  const Solid tube = scenes::difference(cylinder(0.05, 0.1), cylinder(0.03, 0.15));
  const Solid head{.kind = Solid::Kind::placed,
                   .sizes = {},
                   .children = {cylinder(in.between(0.04, 0.05), 0.025)},
                   .placement = {{0, 0, 0.0625}, Quaterniond::Identity()}};
  const Solid pin{.kind = Solid::Kind::sum,
                  .sizes = {},
                  .children = {cylinder(0.02997, 0.1), std::make_shared<Solid>(head)},
                  .placement = {}};
  const double voxel = in.between(0.002, 0.01);
  scene.bodies = {scenes::body_of("tube", tube, voxel), scenes::body_of("pin", pin, voxel)};
  scene.bodies[0].fixed = in.between(0, 1) < 0.3;
  for (BodyDescription& body : scene.bodies) body.density = in.between(1000, 8000);
  scene.bodies[1].X_WB.position.z() = in.between(-0.06, -0.02);
  scene.bodies[1].twist.linear = {in.between(-0.03, 0.03), in.between(-0.03, 0.03), in.between(0.1, 0.5)};
  scene.bodies[1].twist.angular = {0, 0, in.between(-1, 1)};
  return scene;
}

/// Of every scene: nobody goes faster than `fastest`, and one event tells.
template <typename MakeScene>
void expect_told_and_not_thrown(std::uint64_t count, double one_step, double other_step, double fastest,
                                const MakeScene& make_scene) {
  for (const std::uint64_t seed : seeds(count)) {
    Inputs in(seed);
    Scene scene = make_scene(in, in.between(0, 1) < 0.5 ? other_step : one_step);
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Simulation simulation(std::move(scene), {});
    const Found found = run(simulation);
    EXPECT_LE(found.fastest, fastest);
    EXPECT_EQ(found.overlaps.size(), 1U);
  }
}

// What touches elsewhere says nothing of it. Unmended, the head that came out of the wall was thrown: energy x 100.
TEST(Overlap, BesideAContactIsToldOfWhenItShowsAndThrowsNobody) {
  // What it had is at most 0.51 m/s.
  expect_told_and_not_thrown(8, 2e-4, 1e-3, 0.7 + kPushOut, head_in_wall);
}

/// A plate with an upright that carries a knob, and a box that stands flush on the plate, inside of the knob's side and
/// under nothing: what parts it from the knob presses it against other faces.
Scene box_in_knob(Inputs& in, double dt) {
  const double s = std::pow(10, in.between(-2.5, -1.5)), knob = in.between(0.4, 0.8) * s;
  const auto placed = [&](std::vector<double> sizes, const Vector3d& at) {
    return std::make_shared<Solid>(Solid{.kind = Solid::Kind::placed,
                                         .sizes = {},
                                         .children = {scenes::solid(Solid::Kind::box, std::move(sizes))},
                                         .placement = {at, Quaterniond::Identity()}});
  };
  const auto sum = [](std::shared_ptr<const Solid> a, std::shared_ptr<const Solid> b) {
    return std::make_shared<Solid>(
        Solid{.kind = Solid::Kind::sum, .sizes = {}, .children = {std::move(a), std::move(b)}, .placement = {}});
  };
  const auto plate = sum(sum(placed({4 * s, 2 * s, 0.5 * s}, {0, 0, -0.25 * s}),
                             placed({0.3 * s, 0.3 * s, 1.5 * s}, {-1.2 * s, 0, 0.75 * s})),
                         placed({knob, knob, knob}, {-1.05 * s, 0, 1.2 * s}));
  Scene scene = cube_in_plate(s, 0, Quaterniond::Identity(), dt);
  scene.bodies = {scenes::body_of("plate", *plate, s / 6),
                  scenes::body_of("box", *scenes::solid(Solid::Kind::box, {s, s, 1.3 * s}), s / 6)};
  scene.bodies[0].fixed = in.between(0, 1) < 0.5;
  for (BodyDescription& body : scene.bodies) body.density = in.between(500, 8000);
  const double depth = in.between(0.01, 0.35) * s;
  scene.bodies[1].X_WB.position = {-1.05 * s + 0.5 * knob + 0.5 * s - depth, 0, 0.65 * s};
  return scene;
}

// Rows that work against each other on short levers had tens of joules to give: unmended, it left at up to 23 km/s.
TEST(Overlap, WhichNoMotionPartsThrowsNobody) {
  expect_told_and_not_thrown(12, 2e-3, 1e-3, kPushOut, box_in_knob);
}

}  // namespace
}  // namespace verisim::overlap_test
