// What slides over the seam of two bodies that are flush does not feel it: judged from its velocity and height.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/simulation/hybrid_scenes.hpp"
#include "tests/support/random_inputs.hpp"

namespace verisim::seam_test {
namespace {

using verisim::test::Inputs;
using verisim::test::seeds;

/// Two tables of one height side by side, and a ball that comes to the second from the first.
Scene ball_on_tables(Inputs& in) {
  const double radius = std::pow(10, in.between(-2.7, -1.5)), side = 40 * radius;
  Scene scene;
  scene.parameters.hybrid = hybrid::exact;
  scene.parameters.integrator = Integrator::implicit;
  scene.parameters.all_bodies_are_dynamic = true;
  scene.parameters.gravity = {0, 0, -9.81};
  scene.parameters.timestep = in.between(0, 1) < 0.5 ? 1e-3 : 5e-4;
  const Solid table = *scenes::solid(Solid::Kind::box, {side, side, side});
  for (const double x : {-side / 2, side / 2}) {
    BodyDescription& body = scene.bodies.emplace_back(scenes::body_of(x < 0 ? "left" : "right", table, radius));
    body.fixed = true;
    body.X_WB.position = {x, 0, -side / 2};
  }
  BodyDescription& ball =
      scene.bodies.emplace_back(scenes::body_of("ball", *scenes::solid(Solid::Kind::sphere, {radius}), radius / 2));
  ball.density = 2000;
  const double speed = in.between(0.05, 0.15) * radius / scene.parameters.timestep, turn = in.between(-0.7, 0.7);
  ball.twist.linear = {speed * std::cos(turn), speed * std::sin(turn), 0};
  ball.X_WB.position = Vector3d(0, 0, radius) - 20.3 * scene.parameters.timestep * ball.twist.linear;
  scene.parameters.duration = 60 * scene.parameters.timestep;
  return scene;
}

// The edge in front of it is below its side. Unmended, its row was that of a slope that does not end, and took 6 % of
// the speed of a ball of 2.5 mm at 0.4 m/s.
TEST(Seam, IsNotFeltByABall) {
  for (const std::uint64_t seed : seeds(20)) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Inputs in(seed);
    Scene scene = ball_on_tables(in);
    const double height = scene.bodies[2].X_WB.position.z(), speed = scene.bodies[2].twist.linear.norm();
    Simulation simulation(std::move(scene), {});
    double highest = 0;
    while (simulation.frame() < simulation.frames_planned()) {
      simulation.prepare();
      simulation.step();
      highest = std::max(highest, simulation.body_pose(2).position.z() - height);
    }
    EXPECT_GT(simulation.body_pose(2).position.x(), 0) << "it has come over";
    EXPECT_NEAR(simulation.body_twist(2).linear.norm() / speed, 1, 1e-3);
    EXPECT_LE(highest, 1e-6);
  }
}

}  // namespace
}  // namespace verisim::seam_test
