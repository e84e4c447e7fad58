#include "engine/stability/pressed_body.hpp"

#include <cmath>

#include "engine/stability/parts.hpp"

namespace verisim::stability {
namespace {

constexpr double kVoxel = 0.01;           // m
constexpr double kFoot = 5 * kVoxel;      // an edge
constexpr double kDepth = 0.33 * kVoxel;  // where it rests: no other voxels touch within a tenth of a voxel of it
constexpr double kDisturbance = 0.005 * kVoxel;  // near the bound a swing first grows tenfold before it decays

BodyDescription footed_plate(double mass) {
  const Vector3d foot = Vector3d::Constant(kFoot), plate(30 * kVoxel, 30 * kVoxel, 2 * kVoxel);
  BodyDescription body = box_body("body", foot, 1, kVoxel);
  Part upper = box_part("plate", plate);
  for (Vector3d& p : upper.mesh.vertices) p.z() += foot.z() / 2 + plate.z() / 2;
  upper.mass = mass_properties_of(upper.mesh);
  body.parts.push_back(std::move(upper));
  body.density = mass / (foot.prod() + plate.prod());
  return body;
}

/// @param depth  m, of the foot's face below the wall's  @param v  m/s, upwards
Scene scene_of(const PressedBody& body, double depth, double v, double weight) {
  Scene scene;
  SimulationParameters& p = scene.parameters;
  p.timestep = body.step;
  p.all_bodies_are_dynamic = true;
  p.hybrid = hybrid::off;
  p.integrator = body.integrator;
  p.contact_stiffness = body.stiffness;
  p.contact_damping_ratio = body.damping_ratio;
  p.stability_rule = body.stability_rule;
  p.passive_contacts = false;  // depths press springs as they are: one spring, from z = 0 on
  p.gravity = {0, 0, -weight / body.mass};
  BodyDescription wall = box_body("wall", {20 * kVoxel, 20 * kVoxel, 6 * kVoxel}, 1, kVoxel);
  wall.fixed = true;
  wall.X_WB.position = {0, 0, -3 * kVoxel};
  BodyDescription pressed = footed_plate(body.mass);
  pressed.X_WB.position = {0, 0, kFoot / 2 - depth};
  pressed.twist.linear = {0, 0, v};
  scene.bodies = {std::move(wall), std::move(pressed)};
  return scene;
}

/// Of the contacts in one frame.
double force_at(const PressedBody& body, double depth, double v, std::uint64_t* contacts = nullptr) {
  PressedBody asked = body;  // the force at the start of the step is the same in both integrators; only one records it
  asked.integrator = Integrator::semi_implicit;
  Simulation simulation(scene_of(asked, depth, v, 0), {});
  simulation.step();
  if (contacts != nullptr) *contacts = simulation.body_contacts(1);
  return simulation.body_force(1).force.z();
}

}  // namespace

Response response_of(const PressedBody& body) {
  constexpr double kShift = 0.01 * kVoxel;
  Response response;
  response.force = force_at(body, kDepth, 0, &response.contacts);
  response.stiffness = (force_at(body, kDepth + kShift, 0) - force_at(body, kDepth - kShift, 0)) / (2 * kShift);
  // As fast as half of the spring's force: of a force that may only push, half is left.
  const double b = 2 * body.damping_ratio * std::sqrt(response.stiffness * body.mass);
  if (!(b > 0)) return response;
  const double v = 0.25 * response.force / b;
  response.damping = (force_at(body, kDepth, -v) - force_at(body, kDepth, v)) / (2 * v);
  return response;
}

double budget_of(const PressedBody& body, const Response& response) {
  return (response.stiffness * body.step + 2 * response.damping) * body.step / body.mass;
}

Verdict press(const PressedBody& body, const Patience& patience) {
  const double weight = force_at(body, kDepth, 0);
  Simulation simulation(scene_of(body, kDepth + kDisturbance, 0, weight), {});
  const double rest = kFoot / 2 - kDepth;
  return watch(
      simulation, [&] { return simulation.body_pose(1).position.z() - rest; }, kDisturbance, patience);
}

std::optional<PressedBound> bound_of(PressedBody body, const Patience& patience) {
  const double unit = body.mass / (body.step * body.step);  // N/m
  const std::optional<double> last = last_stable(1e-5 * unit, 100 * unit, 1e-3, [&](double stiffness) {
    body.stiffness = stiffness;
    return press(body, patience).outcome == Outcome::stable;
  });
  if (!last) return std::nullopt;
  body.stiffness = *last;
  const Response response = response_of(body);
  return PressedBound{response.stiffness, budget_of(body, response)};
}

}  // namespace verisim::stability
