// Light bodies between heavy ones, down to 1e-9 kg, under `exact`: squeezed, hit or spun, they are not thrown. Judged
// from poses alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "engine/base/pinned_math.hpp"
#include "tests/length.hpp"
#include "tests/simulation/hybrid_scenes.hpp"
#include "tests/support/random_inputs.hpp"

namespace verisim::light_body_test {
namespace {

using test::by_length;
using test::Inputs;
using test::seeds;

constexpr double kGravity = 9.81;
/// m/s. A body goes no faster than it fell and what is heavy goes and turns, but for the creep of what friction holds.
constexpr double kCreeps = 5e-3;
constexpr double kStays = 0.25;  ///< of its width, sideways

struct Column {
  Scene scene;
  std::vector<bool> is_light{};  ///< of each body
  std::vector<double> width{0};  ///< m, of each body
  double fall = 0;               ///< m, sum of all gaps
};

Scene scene_of() {
  Scene scene;
  scene.parameters.hybrid = hybrid::exact;
  scene.parameters.integrator = Integrator::implicit;
  scene.parameters.all_bodies_are_dynamic = true;
  scene.parameters.gravity = {0, 0, -kGravity};
  return scene;
}

/// A box, or a cylinder that stands, of that width and height.
BodyDescription block(std::size_t number, bool round, double width, double height) {
  BodyDescription body = scenes::body_of(std::to_string(number),
                                         round ? *scenes::solid(Solid::Kind::cylinder, {width / 2, height})
                                               : *scenes::solid(Solid::Kind::box, {width, width, height}),
                                         0.3 * std::min(width, height));
  return body;
}

double volume(const BodyDescription& body) {
  return body.parts[0].mass.volume;
}

/// On a plate two to four bodies, one upon the other, near one axis: at least one light, and one heavy above it. Some
/// begin apart, some spin.
Column column(std::uint64_t seed) {
  Inputs in(seed);
  Column column;
  Scene& scene = column.scene = scene_of();
  scene.bodies.push_back(block(0, false, 0.3, 0.02));
  scene.bodies[0].fixed = true;
  scene.bodies[0].X_WB.position.z() = -0.01;
  column.is_light = {false};
  const auto bodies = static_cast<std::size_t>(in.between(2, 4.999));
  const auto light = static_cast<std::size_t>(in.between(1, static_cast<double>(bodies) - 1e-9));
  double narrowest = 1;
  double top = 0;
  for (std::size_t i = 1; i <= bodies; ++i) {
    const bool is_light = i == light || (i < bodies && in.between(0, 1) < 0.4);
    const double width = in.between(0.01, 0.05);
    narrowest = std::min(narrowest, width);
    const double height = in.between(0.3, 1.2) * width;
    BodyDescription body = block(i, in.between(0, 1) < 0.4, width, height);
    body.density = is_light ? pinned::pow(10, in.between(-9, -4)) / volume(body) : pinned::pow(10, in.between(2.5, 4));
    const double gap = in.between(0, 1) < 0.5 ? 0 : in.between(0, 0.003);
    if (in.between(0, 1) < 0.3) body.twist.angular.z() = in.between(-5, 5);
    column.fall += gap;
    body.X_WB.position = {in.between(-1, 1), in.between(-1, 1), top + gap + height / 2};
    body.X_WB.rotation = rotation_from_vector({0, 0, in.between(-2, 2)});
    top += gap + height;
    scene.bodies.push_back(std::move(body));
    column.is_light.push_back(is_light);
    column.width.push_back(width);
  }
  for (std::size_t i = 1; i <= bodies; ++i) scene.bodies[i].X_WB.position.head<2>() *= 0.05 * narrowest;
  return column;
}

/// Three light legs and a heavy table.
Column table(std::uint64_t seed) {
  Inputs in(seed);
  Column column;
  Scene& scene = column.scene = scene_of();
  scene.bodies.push_back(block(0, false, 0.3, 0.02));
  scene.bodies[0].fixed = true;
  scene.bodies[0].X_WB.position.z() = -0.01;
  const double height = in.between(0.005, 0.02);
  const double gap = column.fall = in.between(-0.001, 0.002) < 0 ? 0 : 0.001;
  for (std::size_t i = 1; i <= 3; ++i) {
    column.width.push_back(in.between(0.008, 0.015));
    BodyDescription leg = block(i, i == 1, column.width[i], height);
    leg.density = pinned::pow(10, in.between(-9, -6)) / volume(leg);
    leg.X_WB.position =
        rotation_from_vector({0, 0, pinned::kFullTurn * static_cast<double>(i) / 3}) * Vector3d(0.02, 0, height / 2);
    scene.bodies.push_back(std::move(leg));
  }
  scene.bodies.push_back(block(4, false, 0.06, 0.02));
  scene.bodies[4].density = pinned::pow(10, in.between(2.5, 3.9));
  scene.bodies[4].X_WB.position = {in.between(-0.002, 0.002), in.between(-0.002, 0.002), height + gap + 0.01};
  column.is_light = {false, true, true, true, false};
  return column;
}

/// Of the light bodies of a run: how much faster than what is heavy, there, and their own fall they went, and how far
/// sideways.
struct Thrown {
  double speed = 0;     ///< m/s
  double sideways = 0;  ///< of its width
};

Thrown run(Column column, std::size_t frames) {
  const std::size_t count = column.scene.bodies.size();
  const std::vector<bool> is_light = column.is_light;
  const std::vector<double> width = column.width;
  const double fall = std::sqrt(2 * kGravity * column.fall);
  Simulation simulation(std::move(column.scene), {});
  std::vector<Vector3d> start, before;
  for (std::size_t i = 0; i < count; ++i) start.push_back(simulation.body_pose(i).position);
  before = start;
  Thrown thrown;
  std::vector<double> carried(count);  // m/s, the fastest so far that what is heavy went where a body is
  for (std::size_t frame = 0; frame < frames; ++frame) {
    simulation.prepare();
    simulation.step();
    simulation.clear_events();
    const auto speed = [&](std::size_t i) {
      return (simulation.body_pose(i).position - before[i]).norm() / simulation.dt();
    };
    const auto speed_at = [&](std::size_t heavy, std::size_t i) {
      const Vector3d arm = simulation.body_pose(i).position - simulation.body_pose(heavy).position;
      return (simulation.body_twist(heavy).linear + simulation.body_twist(heavy).angular.cross(arm)).norm();
    };
    for (std::size_t i = 0; i < count; ++i) {
      if (is_light[i]) {
        for (std::size_t j = 0; j < count; ++j)
          if (!is_light[j]) carried[i] = std::max({carried[i], speed(j), speed_at(j, i)});
        thrown.speed = std::max(thrown.speed, speed(i) - carried[i] - fall);
        const double away = (simulation.body_pose(i).position - start[i]).head<2>().norm();
        thrown.sideways = std::max(thrown.sideways, away / width[i]);
      }
      before[i] = simulation.body_pose(i).position;
    }
  }
  return thrown;
}

void expect_none_is_thrown(Column (*make)(std::uint64_t), std::size_t count) {
  std::vector<Thrown> all;
  for (const std::uint64_t seed : seeds(count)) {
    SCOPED_TRACE(seed);
    all.push_back(run(make(seed), 500));
    EXPECT_LE(all.back().speed, kCreeps);
    EXPECT_LE(all.back().sideways, kStays);
  }
  const auto tell = [&](const char* what, double Thrown::*value) {
    std::sort(all.begin(), all.end(), [&](const Thrown& a, const Thrown& b) { return a.*value < b.*value; });
    std::printf("%-9s median %.2g, 95 %% %.2g, at most %.2g\n", what, all[all.size() / 2].*value,
                all[all.size() * 19 / 20].*value, all.back().*value);
  };
  tell("m/s more", &Thrown::speed);
  tell("sideways", &Thrown::sideways);
}

TEST(LightBody, InAColumnIsNotThrown) {
  expect_none_is_thrown(column, by_length<std::size_t>(4, 60, 300));
}

TEST(LightBody, AsALegIsNotThrown) {
  expect_none_is_thrown(table, by_length<std::size_t>(1, 5, 60));
}

// Without a plate, weight or anything else: two heavy ones fly at a light one from both sides. It may slip out when
// they turn on together; momentum stays.
TEST(LightBody, BetweenTwoThatFlyAtItTakesNoMomentum) {
  for (const std::uint64_t seed : seeds(by_length<std::uint64_t>(3, 12, 60))) {
    SCOPED_TRACE(seed);
    Inputs in(seed);
    Scene scene = scene_of();
    scene.parameters.gravity = Vector3d::Zero();
    for (std::size_t i = 0; i < 3; ++i) {
      BodyDescription body = block(i, i == 1 && seed % 2 == 0, in.between(0.01, 0.03), 0.02);
      const double side = static_cast<double>(i) - 1;
      body.density = i == 1 ? pinned::pow(10, in.between(-9, -4)) / volume(body) : pinned::pow(10, in.between(2, 4));
      body.X_WB.position = {in.between(-1e-3, 1e-3), in.between(-1e-3, 1e-3), side * in.between(0.0201, 0.03)};
      body.twist.linear.z() = -side * in.between(0.05, 1);
      body.twist.angular.z() = in.between(-3, 3);
      scene.bodies.push_back(std::move(body));
    }
    Simulation simulation(std::move(scene), {});
    double summed = 0;  // N s
    Vector3d start = Vector3d::Zero();
    for (std::size_t i = 0; i < 3; ++i) {
      start += simulation.mass(i) * simulation.body_twist(i).linear;
      summed += (simulation.mass(i) * simulation.body_twist(i).linear).norm();
    }
    for (int frame = 0; frame < 200; ++frame) {
      simulation.prepare();
      simulation.step();
      Vector3d now = Vector3d::Zero();
      for (std::size_t i = 0; i < 3; ++i) now += simulation.mass(i) * simulation.body_twist(i).linear;
      summed += simulation.dt() * simulation.body_force(0).force.norm();
      ASSERT_LE((now - start).norm(), 1e-9 * summed) << frame;
    }
  }
}

}  // namespace
}  // namespace verisim::light_body_test
