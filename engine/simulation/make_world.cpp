// How a scene becomes a World.
#include <algorithm>
#include <cmath>

#include "engine/base/error.hpp"
#include "engine/exact/convex_step.hpp"
#include "engine/geometry/merged.hpp"
#include "engine/simulation/hybrid_method.hpp"
#include "engine/simulation/world.hpp"
#include "engine/voxel/association.hpp"
#include "engine/voxel/voxelize.hpp"

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
  if (!p.gravity.allFinite()) fail(ErrorKind::input, "gravity is not finite");
  if (p.duration) positive(*p.duration, "duration", "s");
}

double distance(const Bounds& a, const Bounds& b) {
  return (a.min - b.max).cwiseMax(b.min - a.max).cwiseMax(0).norm();
}

void forget_brep(Part& part) {
  part.faces.clear();
  part.edges.clear();
  part.mesh.face_of_triangle.clear();
}

Bounds in_world(const Bounds& bounds_B, const Pose& X_WB) {
  Bounds world;
  for (int corner = 0; corner < 8; ++corner)
    world.include(X_WB * Vector3d((corner & 1) != 0 ? bounds_B.max.x() : bounds_B.min.x(),
                                  (corner & 2) != 0 ? bounds_B.max.y() : bounds_B.min.y(),
                                  (corner & 4) != 0 ? bounds_B.max.z() : bounds_B.min.z()));
  return world;
}

}  // namespace

double box_gap(const Body& a, const Body& b) {
  return distance(in_world(a.bounds_B, a.rigid.pose()), in_world(b.bounds_B, b.rigid.pose()));
}

double grown_by(const Body& body) {
  return body.voxels ? 2 * body.voxels->voxmap.voxel_size : 0;
}

namespace {

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
}

Body place_body(const Scene& scene, const World& world, std::size_t index) {
  const BodyDescription& description = scene.bodies[index];
  const SimulationParameters& p = world.parameters;
  check_closed(description);
  for (const Body& other : world.bodies)
    if (other.name == description.name)
      fail(ErrorKind::input, "two objects are called '{}'; names are how run files tell bodies apart",
           description.name);
  Body body;
  body.name = description.name;
  const MassProperties mass = merged(description.parts).mass;
  body.rigid = make_body(body.name, mass.volume, mass.centroid, mass.inertia, description.density);
  if (!description.X_WB.position.allFinite() || !description.X_WB.rotation.coeffs().allFinite())
    fail(ErrorKind::input, "'{}': its start pose is not finite", body.name);
  body.rigid.set_pose(description.X_WB);
  body.rigid.v_C = description.twist.linear;
  body.rigid.omega = description.twist.angular;
  body.method = p.contact == ContactMethod::fcl ? hybrid::off : description.hybrid.value_or(p.hybrid);
  body.hybrid_enabled = description.hybrid_enabled;
  body.selectable = description.selectable && !description.fixed;
  const bool grasped =
      std::any_of(scene.grasps.begin(), scene.grasps.end(), [&](const Grasp& g) { return g.body == index; });
  body.can_move =
      !description.fixed && (p.all_bodies_are_dynamic || grasped || (body.selectable && !scene.devices.empty()));
  for (const Part& part : description.parts)
    for (const Vector3d& v : part.mesh.vertices) body.bounds_B.include(v);
  const CouplingLimits limits{p.max_stiffness, p.max_angular_stiffness, p.max_coupling_force, p.max_coupling_torque};
  body.coupling = make_coupling(body.rigid, world.dt, limits, !world.is_implicit());
  return body;
}

/// How far the surface of a body can get from where it starts [m]; infinite for what flies freely.
double reach_of(const World& world, const Body& body) {
  if (!body.can_move) return 0;
  if (world.parameters.all_bodies_are_dynamic) return std::numeric_limits<double>::infinity();
  double travel = 0;
  for (const Hand& hand : world.hands) travel = std::max(travel, hand.device->travel());
  return travel + body.bounds_B.size().norm();  // a body that turns sweeps its own size
}

bool may_meet_another(const World& world, std::size_t i) {
  const Body& body = world.bodies[i];
  for (std::size_t j = 0; j < world.bodies.size(); ++j) {
    const Body& other = world.bodies[j];
    if (i == j || !(body.can_move || other.can_move)) continue;
    if (box_gap(body, other) <= reach_of(world, body) + reach_of(world, other)) return true;
  }
  return false;
}

void voxelize_body(const BodyDescription& description, const SimulationParameters& p, unsigned threads, Body& body) {
  VoxelizeOptions options;
  options.voxel_size = description.voxel_size;
  options.point_spacing = description.point_spacing;
  options.threads = threads;
  Part part = merged(description.parts);
  if (!description.use_brep) forget_brep(part);
  auto voxels = std::make_shared<VoxelBody>(voxelize(description.name, part.mesh, options));
  if (body.method->needs_entities() && (part.has_brep() || description.declared))
    associate(description.name, part, {.threads = threads, .declared = description.declared.get()}, *voxels);
  body.voxels = std::move(voxels);
  if (p.contact == ContactMethod::fcl) body.mesh = std::make_unique<MeshTree>(part.mesh);
}

/// What the body's method needs of its entities.
void make_entities(const BodyDescription& description, const World& world, Body& body) {
  const BodyFeatures& features = body.voxels->features;
  if (features.entity_count() == 0) return;
  body.entities = std::make_unique<EntitySets>(features.faces, features.edges, features.sets);
  if (!body.method->needs_precise_surfaces() || !description.use_brep) return;
  exact::BodyOptions options;
  options.spacing = description.voxel_size;
  auto precise = std::make_shared<exact::ExactBody>(description.parts, options);
  if (precise->has_precise_faces()) body.exact = std::move(precise);
  const auto solved =
      std::count_if(world.bodies.begin(), world.bodies.end(), [](const Body& b) { return b.exact && b.can_move; });
  if (solved > exact::ConvexStep::kBodiesMax)
    fail(ErrorKind::input, "'{}': more than {} moving bodies are 'exact'; give the others hybrid = \"restore\"",
         body.name, exact::ConvexStep::kBodiesMax);
}

}  // namespace

World make_world(const Scene& scene, unsigned threads, std::vector<Event>& events) {
  check(scene.parameters);
  World world{.parameters = scene.parameters,
              .dt = scene.parameters.timestep,
              .bodies = {},
              .links = {},
              .hands = {},
              .companions = scene.companions,
              .clocks = Clocks(scene.parameters.timestep)};
  choose_integrator(scene, world, events);
  for (const auto& device : scene.devices) world.hands.emplace_back().device = device;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) world.bodies.push_back(place_body(scene, world, i));
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (!may_meet_another(world, i)) continue;
    voxelize_body(scene.bodies[i], world.parameters, threads, world.bodies[i]);
    make_entities(scene.bodies[i], world, world.bodies[i]);
  }
  for (std::size_t i = 0; i < world.bodies.size(); ++i)
    for (std::size_t j = i + 1; j < world.bodies.size(); ++j)
      if (world.bodies[i].can_move || world.bodies[j].can_move) world.links.push_back({i, j});
  return world;
}

}  // namespace verisim
