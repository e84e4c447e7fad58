// Restitution and stiffness of contacts under `exact`: what is hit rebounds with e of its speed of approach, what lies
// lies still, nothing gains energy, and the extremes of stiffness are as stable as the usual one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/length.hpp"
#include "tests/simulation/hybrid_scenes.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/tolerance.hpp"

namespace verisim::restitution_test {
namespace {

using test::expect_refused;
using test::tolerance;

constexpr std::size_t kPlate = 0, kBody = 1;
constexpr double kGravity = 9.81;

/// A body above a plate whose top is at z = 0.
Scene above_plate(const BodyDescription& body, double height) {
  static const BodyDescription plate =
      scenes::body_of("plate", *scenes::solid(Solid::Kind::box, {0.1, 0.1, 0.02}), 0.004);
  Scene scene;
  scene.parameters.hybrid = hybrid::exact;
  scene.parameters.all_bodies_are_dynamic = true;
  scene.parameters.gravity = {0, 0, -kGravity};
  scene.bodies = {plate, body};
  scene.bodies[kPlate].fixed = true;
  scene.bodies[kPlate].X_WB.position.z() = -0.01;
  scene.bodies[kBody].density = 1000;
  scene.bodies[kBody].X_WB.position = {0.003, -0.002, height};
  return scene;
}
const BodyDescription& ball(double radius) {
  static const std::array balls = {scenes::body_of("ball", *scenes::solid(Solid::Kind::sphere, {0.005}), 0.002),
                                   scenes::body_of("ball", *scenes::solid(Solid::Kind::sphere, {0.02}), 0.004)};
  return radius == 0.005 ? balls[0] : balls[1];
}
const BodyDescription& box() {
  static const BodyDescription box =
      scenes::body_of("box", *scenes::solid(Solid::Kind::box, {0.03, 0.03, 0.03}), 0.004);
  return box;
}

double energy_of(const Simulation& simulation) {
  return simulation.energy().kinetic + simulation.energy().gravity;
}

/// A ball is dropped, up to its first rebound and the top of its flight.
struct Bounce {
  double approach = 0, rebound = 0;  ///< m/s
  double dropped = 0, reached = 0;   ///< m, above where it rests
  double energy_gain = 0;            ///< of the energy of the fall
};
Bounce bounce_of(Scene scene, double radius) {
  Simulation simulation(std::move(scene), {});
  const auto height = [&] { return simulation.body_pose(kBody).position.z() - radius; };
  const auto speed = [&] { return simulation.body_twist(kBody).linear.z(); };
  Bounce bounce;
  bounce.dropped = height();
  const double before = energy_of(simulation);
  const double fall = simulation.mass(kBody) * kGravity * bounce.dropped;
  const double dt = simulation.dt();
  for (double t = 0; t < 3 && (bounce.rebound == 0 || speed() > 0); t += dt) {
    const double last = speed();
    simulation.prepare();
    simulation.step();
    if (bounce.rebound == 0 && simulation.body_force(kBody).force.z() > 0) {
      bounce.approach = -last;
      bounce.rebound = speed();
    }
    bounce.reached = bounce.rebound > 0 ? std::max(bounce.reached, height()) : 0;
    bounce.energy_gain = std::max(bounce.energy_gain, (energy_of(simulation) - before) / fall);
    if (bounce.rebound < 0) break;
  }
  return bounce;
}

TEST(Ball, ReboundsWithThatPartOfItsSpeedOfApproach) {
  for (const double radius : {0.005, 0.02})
    for (const double height : {0.05, 0.3})
      for (const double dt : test::some_of({0.001, 0.0002, 0.004}))
        for (const double stiffness : {1e6, 1.15e11, 1e13})
          for (const double e : test::some_of({0.2, 0.5, 0.8, 1.0})) {
            Scene scene = above_plate(ball(radius), radius + height);
            scene.parameters.timestep = dt;
            scene.parameters.restitution = e;
            scene.parameters.exact_stiffness = stiffness;
            const Bounce bounce = bounce_of(std::move(scene), radius);
            SCOPED_TRACE(testing::Message() << "e " << e << ", radius " << radius << ", height " << height << ", dt "
                                            << dt << ", stiffness " << stiffness);
            ASSERT_NEAR(bounce.approach, std::sqrt(2 * kGravity * height), 2 * kGravity * dt);
            ASSERT_NEAR(bounce.rebound, e * bounce.approach, tolerance(0.001 * e * bounce.approach));
            // The height that belongs to it, but for what one step of the fall is worth on either side.
            const double speed = std::sqrt(2 * kGravity * bounce.reached);
            ASSERT_LE(speed, e * std::sqrt(2 * kGravity * bounce.dropped) + 1e-9);
            ASSERT_NEAR(speed, e * bounce.approach, 1.5 * kGravity * dt + 0.001);
            ASSERT_LE(bounce.energy_gain, 1e-9);
          }
}

/// What is dropped by 5 mm is followed for 30 ms after it touches.
struct Landing {
  double approach = 0, rebound = 0;  ///< m/s, largest upwards after it touched
  double mass = 0;                   ///< kg
  double uneven = 0;                 ///< of the weight: how far its force is from it in the last 5 ms
};
Landing landing_of(Scene scene) {
  Simulation simulation(std::move(scene), {});
  const double weight = simulation.mass(kBody) * kGravity;
  const double dt = simulation.dt();
  Landing landing;
  landing.mass = simulation.mass(kBody);
  for (double since = 0; since < 0.03;) {
    const double last = simulation.body_twist(kBody).linear.z();
    simulation.prepare();
    simulation.step();
    const double force = simulation.body_force(kBody).force.z();
    if (landing.approach == 0 && force > 0) landing.approach = -last;
    if (landing.approach == 0) continue;
    since += dt;
    landing.rebound = std::max(landing.rebound, simulation.body_twist(kBody).linear.z());
    if (since > 0.025) landing.uneven = std::max(landing.uneven, std::abs(force / weight - 1));
  }
  return landing;
}

// Without restitution nothing rebounds, and what lies does not ring, however short the step is beside the time of a
// contact's spring and however soft the contact.
TEST(Landing, WithoutRestitutionIsInelasticAtAnyStepAndStiffness) {
  for (const BodyDescription* body : {&ball(0.005), &ball(0.02), &box()})
    for (const double density : test::some_of({1000.0, 1.0, 1e6}))
      for (const double dt : {1e-3, 1e-4, 1e-5})
        for (const double stiffness : test::some_of({1.15e11, 1e6, 1e9, 1e13})) {
          const double half = body == &box() ? 0.015 : body == &ball(0.02) ? 0.02 : 0.005;
          Scene scene = above_plate(*body, half + 0.005);
          scene.bodies[kBody].density = density;
          scene.parameters.timestep = dt;
          scene.parameters.exact_stiffness = stiffness;
          const Landing landing = landing_of(std::move(scene));
          SCOPED_TRACE(testing::Message() << body->name << " of " << 2 * half << " m, density " << density << ", dt "
                                          << dt << ", stiffness " << stiffness);
          ASSERT_NEAR(landing.approach, std::sqrt(2 * kGravity * 0.005), 2 * kGravity * dt);
          EXPECT_LE(landing.rebound, 0.1 * landing.approach);
          const double yields = std::sqrt(landing.mass / (0.004 * stiffness));  // s, at a point
          if (yields < 0.001) {
            EXPECT_LE(landing.uneven, tolerance(0.01));
          }
        }
}

// No bounce is forever: a ball and a box that rebound well come to rest, and what rests does not buzz. The force has
// the roundings of a gap (1e-15 m) times the stiffness, with and without restitution.
TEST(Rest, StaysRestWhateverTheRestitution) {
  for (const double e : {0.3, 0.7}) {
    for (const BodyDescription* body : {&ball(0.02), &box()}) {
      SCOPED_TRACE(testing::Message() << body->name << ", e " << e);
      Scene scene = above_plate(*body, 0.03);
      scene.parameters.restitution = e;
      Simulation simulation(std::move(scene), {});
      const double weight = simulation.mass(kBody) * kGravity;
      for (int i = 0; i < 2000; ++i) {
        simulation.prepare();
        simulation.step();
        if (i < 1500) continue;
        ASSERT_NEAR(simulation.body_force(kBody).force.z(), weight, tolerance(1e-5 * weight)) << "frame " << i;
        ASSERT_LE(simulation.body_twist(kBody).linear.norm(), tolerance(1e-8)) << "frame " << i;
      }
    }
  }
}

// Placed where it rests and never touched again: as with no restitution at all, to the bit.
TEST(Rest, IsTheSameToTheBitWithAndWithoutRestitution) {
  const auto hash = [](double e) {
    Scene scene = above_plate(box(), 0.015);
    scene.parameters.restitution = e;
    Simulation simulation(std::move(scene), {});
    for (int i = 0; i < 200; ++i) {
      simulation.prepare();
      simulation.step();
    }
    return simulation.state_hash();
  };
  EXPECT_EQ(hash(0), hash(0.9));
}

// Balls in a row, a step's way and more apart, the first of which flies at the others: e = 1 hands the speed on.
TEST(RowOfBalls, HandsItsMomentumOn) {
  constexpr int kBalls = 10;
  for (const double gap : {0.0, 0.0002, 0.003}) {
    SCOPED_TRACE(gap);
    Scene scene;
    scene.parameters.hybrid = hybrid::exact;
    scene.parameters.all_bodies_are_dynamic = true;
    scene.parameters.restitution = 1;
    for (int i = 0; i < kBalls; ++i) {
      BodyDescription& body = scene.bodies.emplace_back(ball(0.005));
      body.name = std::to_string(i);
      body.X_WB.position = {i * (0.01 + gap), 0, 0};
      if (i == 0) body.X_WB.position.x() -= 0.002;
    }
    scene.bodies[0].twist.linear = {1, 0, 0};
    Simulation simulation(std::move(scene), {});
    const double before = simulation.energy().kinetic;
    for (int i = 0; i < 100; ++i) {
      simulation.prepare();
      simulation.step();
      double momentum = 0;
      for (std::size_t b = 0; b < kBalls; ++b) momentum += simulation.body_twist(b).linear.x();
      ASSERT_NEAR(momentum, 1, tolerance(1e-9));
      ASSERT_LE(simulation.energy().kinetic, before * (1 + 1e-6)) << "more than the rows' springs held";
    }
    // Of balls nearer than a step's way several are hit in one step, at places where they will only be at its end.
    EXPECT_GE(simulation.energy().kinetic, before * (gap == 0.0002 ? 0.8 : 0.99));
    if (gap > 0.001) {
      EXPECT_NEAR(simulation.body_twist(kBalls - 1).linear.x(), 1, 0.01);
    }
  }
}

// A box that falls on an edge and comes to lie, at every stiffness that is allowed to be asked for and makes sense.
TEST(Stiffness, IsStableOverItsWholeRange) {
  for (double stiffness = 1e6; stiffness < 2e13; stiffness *= 10) {
    SCOPED_TRACE(stiffness);
    Scene scene = above_plate(box(), 0.04);
    scene.parameters.exact_stiffness = stiffness;
    scene.bodies[kBody].X_WB.rotation = rotation_from_vector({0.4, 0, 0});
    Simulation simulation(std::move(scene), {});
    const double before = energy_of(simulation);
    const double weight = simulation.mass(kBody) * kGravity;
    for (int i = 0; i < 1500; ++i) {
      simulation.prepare();
      simulation.step();
      ASSERT_LE(energy_of(simulation) - before, 0.01 * weight * 0.04) << "frame " << i;
    }
    EXPECT_NEAR(simulation.body_force(kBody).force.z(), weight, tolerance(1e-4 * weight));
    EXPECT_GT(simulation.body_pose(kBody).position.z(), 0.015 - 2e-5);
  }
}

TEST(Parameters, OfContactAreRefusedWithOneLine) {
  const auto refuse = [](auto set, double bad, const std::string& wanted) {
    SCOPED_TRACE(bad);
    Scene scene = above_plate(box(), 0.04);
    set(scene.parameters, bad);
    expect_refused([&] { return Simulation(scene, {}).frame(); }, wanted);
  };
  const double none = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {-0.1, 1.001, none}) {
    refuse([](SimulationParameters& p, double v) { p.restitution = v; }, bad, "restitution is ");
    refuse([](SimulationParameters& p, double v) { p.exact_friction = v; }, bad, "exactFriction is ");
  }
  for (const double bad : {0.0, -1.0, none, std::numeric_limits<double>::infinity()}) {
    refuse([](SimulationParameters& p, double v) { p.exact_stiffness = v; }, bad, "exactStiffness is ");
    refuse([](SimulationParameters& p, double v) { p.restitution_speed = v; }, bad, "restitutionSpeed is ");
  }
}

}  // namespace
}  // namespace verisim::restitution_test
