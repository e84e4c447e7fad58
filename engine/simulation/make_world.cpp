// How a scene becomes a World.
#include <algorithm>
#include <cmath>
#include <string_view>
#include <unordered_set>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/exact/convex_step.hpp"
#include "engine/geometry/merged.hpp"
#include "engine/simulation/body_maker.hpp"
#include "engine/simulation/hybrid_method.hpp"
#include "engine/simulation/world.hpp"

namespace verisim {
namespace {

void check_closed(const BodyDescription& body) {
  if (body.parts.empty()) fail(ErrorKind::input, "'{}': has no model and no solid; give it one", body.name);
  for (const Part& part : body.parts)
    if (!part.watertight)
      fail(ErrorKind::input,
           "'{}': part '{}' does not bound a solid ({}); repair the model, 'verisim inspect' shows where", body.name,
           part.name, part.notes.empty() ? "open mesh" : part.notes.back());
}

void check_names(const Scene& scene) {
  std::unordered_set<std::string_view> names;
  for (const BodyDescription& body : scene.bodies)
    if (!names.insert(body.name).second)
      fail(ErrorKind::input, "two objects are called '{}'; names are how run files tell bodies apart", body.name);
}

void check(const SimulationParameters& p) {
  const auto positive = [](double v, const char* name, const char* unit) {
    if (!std::isfinite(v) || v <= 0)
      fail(ErrorKind::input, "{} is {} {} but must be finite and above 0", name, v, unit);
  };
  positive(p.timestep, "timestep", "s");
  if (p.timestep < 1e-6 || p.timestep > 1)
    fail(ErrorKind::input, "timestep is {} s; steps from 0.000001 to 1 s are simulated", p.timestep);
  positive(p.frame_rate, "frameRate", "Hz");
  positive(p.max_stiffness, "maxStiffness", "N/m");
  positive(p.max_angular_stiffness, "maxAngularStiffness", "N m/rad");
  if (!(p.max_coupling_force > 0)) fail(ErrorKind::input, "maxCouplingForce must be above 0 N");
  if (!(p.max_coupling_torque > 0)) fail(ErrorKind::input, "maxCouplingTorque must be above 0 N m");
  positive(p.contact_stiffness, "contactStiffness", "N/m");
  if (!std::isfinite(p.contact_damping_ratio) || p.contact_damping_ratio < 0)
    fail(ErrorKind::input, "contactDampingRatio is {} but must be finite and not negative", p.contact_damping_ratio);
  if (!std::isfinite(p.coupling_damping_ratio) || p.coupling_damping_ratio < 0)
    fail(ErrorKind::input, "couplingDampingRatio is {} but must be finite and not negative", p.coupling_damping_ratio);
  positive(p.exact_stiffness, "exactStiffness", "N/m^2");
  if (!is_fraction(p.restitution)) fail(ErrorKind::input, "restitution is {} but must be from 0 to 1", p.restitution);
  if (!is_fraction(p.exact_friction))
    fail(ErrorKind::input, "exactFriction is {} but must be from 0 to 1", p.exact_friction);
  positive(p.restitution_speed, "restitutionSpeed", "m/s");
  if (!p.gravity.allFinite()) fail(ErrorKind::input, "gravity is not finite");
  if (p.duration) positive(*p.duration, "duration", "s");
}

}  // namespace

Bounds world_box(const Body& body) {
  const Pose X_WB = body.rigid.pose();
  const Bounds& b = body.bounds_B;
  Bounds world;
  for (int corner = 0; corner < 8; ++corner)
    world.include(X_WB * Vector3d((corner & 1) != 0 ? b.max.x() : b.min.x(), (corner & 2) != 0 ? b.max.y() : b.min.y(),
                                  (corner & 4) != 0 ? b.max.z() : b.min.z()));
  return world;
}

double gap(const Bounds& a, const Bounds& b) {
  return (a.min - b.max).cwiseMax(b.min - a.max).cwiseMax(0).norm();
}

namespace {

constexpr double kLargestVoxel = 1e12;  // m: sums and squares of such lengths are still numbers

bool can_move(const Scene& scene, std::size_t index) {
  const BodyDescription& body = scene.bodies[index];
  if (body.fixed) return false;
  if (scene.parameters.all_bodies_are_dynamic || (body.selectable && !scene.devices.empty())) return true;
  return std::any_of(scene.grasps.begin(), scene.grasps.end(), [&](const Grasp& g) { return g.body == index; });
}

/// Why `exact` is not the method of a scene that names none; empty: it is.
std::string reason_against_exact(const Scene& scene) {
  const SimulationParameters& p = scene.parameters;
  if (p.contact == ContactMethod::fcl) return "contact = \"fcl\" finds triangles";
  if (!p.integrator_by_default && p.integrator != Integrator::implicit)
    return "integrator = \"semi-implicit\" was asked for, and 'exact' is implicit";
  std::size_t known = 0;
  std::size_t solved = 0;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (!will_be_exact(scene.bodies[i], scene.bodies[i].hybrid.value_or(hybrid::exact))) continue;
    ++known;
    if (can_move(scene, i)) ++solved;
  }
  if (known < 2) return "fewer than two bodies have faces that 'exact' knows";
  if (solved > static_cast<std::size_t>(exact::ConvexStep::kDenseMax))
    return fmt::format("{} bodies would move, and more than {} take 'exact' milliseconds a frame", solved,
                       exact::ConvexStep::kDenseMax);
  return {};
}

/// The method of a scene that names none: `exact` if it can act, else `restore`, and an event says why.
void choose_method(const Scene& scene, World& world, std::vector<Event>& events) {
  if (!world.parameters.hybrid_by_default || scene.bodies.size() < 2) return;
  const std::string reason = reason_against_exact(scene);
  if (reason.empty())
    world.parameters.hybrid = hybrid::exact;
  else
    events.push_back(
        {0, "hybrid",
         fmt::format("no method was named: '{}' acts, not 'exact': {}", world.parameters.hybrid->name(), reason)});
}

/// Precise surfaces need the implicit integrator; FCL's contacts belong to no voxel whose faces would be known.
void choose_integrator(const Scene& scene, World& world, std::vector<Event>& events) {
  bool asked_for = false;
  for (const BodyDescription& body : scene.bodies) {
    const Hybrid method = body.hybrid.value_or(world.parameters.hybrid);
    asked_for = asked_for || method->needs_entities();
    if (world.parameters.contact == ContactMethod::voxmap && method->needs_precise_surfaces())
      world.parameters.integrator = Integrator::implicit;
  }
  if (world.parameters.contact == ContactMethod::fcl && asked_for)
    events.push_back({0, "hybrid",
                      "contact = \"fcl\" finds triangles, not voxels with faces: every contact is as with hybrid = "
                      "\"off\""});
  const auto is_blended = [&](const BodyDescription& b) {
    return b.hybrid.value_or(world.parameters.hybrid) == hybrid::blend;
  };
  if (world.parameters.all_bodies_are_dynamic && std::any_of(scene.bodies.begin(), scene.bodies.end(), is_blended))
    events.push_back(
        {0, "hybrid", "'blend' pulls as a hand does: where no hand holds one of two bodies it acts as 'off'"});
}

/// Gravity pulls at what moves freely. Held bodies follow their device, as SPARTA's do: they have weight only where all
/// bodies are dynamic.
void check_gravity(const SimulationParameters& p, std::vector<Event>& events) {
  if (p.gravity.isZero(0) || p.all_bodies_are_dynamic) return;
  events.push_back({0, "gravity",
                    fmt::format("gravity ({:g}, {:g}, {:g}) m/s^2 acts on no body, held ones neither: it does with "
                                "allBodiesAreDynamic = true",
                                p.gravity.x(), p.gravity.y(), p.gravity.z())});
}

Body place_body(const Scene& scene, const World& world, std::size_t index) {
  const BodyDescription& description = scene.bodies[index];
  const SimulationParameters& p = world.parameters;
  check_closed(description);
  Body body;
  body.name = description.name;
  const MassProperties mass = merged(description.parts).mass;
  body.rigid = make_body(body.name, mass.volume, mass.centroid, mass.inertia, description.density);
  if (!description.X_WB.position.allFinite() || !description.X_WB.rotation.coeffs().allFinite())
    fail(ErrorKind::input, "'{}': its start pose is not finite", body.name);
  if (!is_finite(description.twist.linear) || !is_finite(description.twist.angular))
    fail(ErrorKind::input, "'{}': its start velocity is not finite", body.name);
  if (!(description.voxel_size <= kLargestVoxel))
    fail(ErrorKind::input, "'{}': voxelsize is {:g} m, more than the {:g} m that are computed with; mm(8) is usual",
         body.name, description.voxel_size, kLargestVoxel);
  body.rigid.set_pose(description.X_WB);
  body.rigid.v_C = description.twist.linear;
  body.rigid.omega = description.twist.angular;
  body.voxel_size = description.voxel_size;
  body.surface = known_surface(description);
  body.asked = description.hybrid.value_or(p.hybrid);
  body.method = p.contact == ContactMethod::fcl ? hybrid::off : body.asked;
  body.hybrid_enabled = description.hybrid_enabled;
  body.selectable = description.selectable && !description.fixed;
  body.can_move = can_move(scene, index);
  for (const Part& part : description.parts)
    for (const Vector3d& v : part.mesh.vertices) body.bounds_B.include(v);
  const CouplingLimits limits{p.max_stiffness, p.max_angular_stiffness, p.max_coupling_force, p.max_coupling_torque,
                              p.coupling_damping_ratio};
  body.coupling = make_coupling(body.rigid, world.dt, limits, !world.is_implicit() && p.stability_rule);
  return body;
}

}  // namespace

World make_world(const Scene& scene, std::vector<Event>& events) {
  check(scene.parameters);
  VERISIM_ASSERT(scene.parameters.hybrid != nullptr);
  for (const BodyDescription& body : scene.bodies) VERISIM_ASSERT(!body.hybrid || *body.hybrid != nullptr);
  for (const auto& device : scene.devices) VERISIM_ASSERT(device != nullptr);
  for (const auto& companion : scene.companions) VERISIM_ASSERT(companion != nullptr);
  for (const Grasp& grasp : scene.grasps) VERISIM_ASSERT(grasp.device < scene.devices.size());
  for (const Grasp& grasp : scene.grasps) VERISIM_ASSERT(grasp.body < scene.bodies.size());
  VERISIM_ASSERT(is_positive(scene.grasp_distance));
  World world{.parameters = scene.parameters,
              .dt = scene.parameters.timestep,
              .bodies = {},
              .links = {},
              .near_links = {},
              .moving = {},
              .busy = {},
              .hands = {},
              .companions = scene.companions,
              .clocks = Clocks(scene.parameters.timestep)};
  choose_method(scene, world, events);
  choose_integrator(scene, world, events);
  check_gravity(world.parameters, events);
  check_names(scene);
  for (const auto& device : scene.devices) {
    world.hands.emplace_back().device = device;
    device->practise({.name = device->name(), .gain = device->gain(), .workspace = device->workspace()});
    events.push_back({0, "device", device->described()});
  }
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) world.bodies.push_back(place_body(scene, world, i));
  world.moving.reserve(world.bodies.size());
  world.busy.reserve(world.bodies.size());
  world.list_moving();
  return world;
}

}  // namespace verisim
