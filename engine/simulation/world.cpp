#include "engine/simulation/world.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/error.hpp"
#include "engine/geometry/merged.hpp"
#include "engine/voxel/association.hpp"
#include "engine/voxel/voxelize.hpp"
#include "engine/wii/head.hpp"

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

Simulation::Implementation::Implementation(Scene scene, const SimulationOptions& options)
    : parameters(scene.parameters),
      dt((check(scene.parameters), scene.parameters.timestep)),
      threads(options.threads),
      devices(scene.devices),
      held(scene.devices.size()),
      heads(scene.heads),
      grasp_distance(scene.grasp_distance),
      clocks(scene.parameters.timestep) {
  events.reserve(1024);
  choose_methods(scene);
  double longest = 0;
  for (const auto& device : devices) longest = std::max(longest, device->duration());
  for (const auto& head : heads) longest = std::max(longest, head->duration());
  const double duration = parameters.duration ? *parameters.duration : (longest > 0 ? longest : 1.0);
  frames_planned = static_cast<std::uint64_t>(std::llround(duration / dt));

  place_bodies(scene);
  voxelize_bodies(scene);
  make_links();
  make_schema();
  first_grasps = scene.grasps;
  energy = energy_now();
  ledger.start(energy);
}

/// The exact response needs the implicit integrator; FCL's contacts belong to no voxel whose faces would be known.
void Simulation::Implementation::choose_methods(const Scene& scene) {
  bool asked_for = false;
  for (const BodyDescription& body : scene.bodies) {
    const Hybrid hybrid = body.hybrid.value_or(parameters.hybrid);
    asked_for |= hybrid != Hybrid::off;
    if (parameters.contact == ContactMethod::voxmap && hybrid == Hybrid::exact)
      parameters.integrator = Integrator::implicit;
  }
  if (parameters.contact == ContactMethod::fcl && asked_for)
    events.push_back({0, "hybrid",
                      "contact = \"fcl\" finds triangles, not voxels with faces: every contact is as with hybrid = "
                      "\"off\""});
}

void Simulation::Implementation::place_bodies(const Scene& scene) {
  for (const BodyDescription& description : scene.bodies) {
    check_closed(description);
    for (const Body& other : bodies)
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
    body.hybrid =
        parameters.contact == ContactMethod::fcl ? Hybrid::off : description.hybrid.value_or(parameters.hybrid);
    body.hybrid_enabled = description.hybrid_enabled;
    body.selectable = description.selectable && !description.fixed;
    const std::size_t index = bodies.size();
    const bool grasped =
        std::any_of(scene.grasps.begin(), scene.grasps.end(), [&](const Grasp& g) { return g.body == index; });
    body.can_move =
        !description.fixed && (parameters.all_bodies_are_dynamic || grasped || (body.selectable && !devices.empty()));
    for (const Part& part : description.parts)
      for (const Vector3d& v : part.mesh.vertices) body.bounds_B.include(v);
    const CouplingLimits limits{parameters.max_stiffness, parameters.max_angular_stiffness,
                                parameters.max_coupling_force, parameters.max_coupling_torque};
    body.coupling = make_coupling(body.rigid, dt, limits, parameters.integrator == Integrator::semi_implicit);
    bodies.push_back(std::move(body));
  }
}

double Simulation::Implementation::box_gap(const Body& a, const Body& b) {
  return distance(in_world(a.bounds_B, a.rigid.pose()), in_world(b.bounds_B, b.rigid.pose()));
}

double Simulation::Implementation::grown_by(const Body& body) {
  return body.voxels ? 2 * body.voxels->voxmap.voxel_size : 0;
}

/// How far the surface of a body can get from where it starts [m]; infinite for what flies freely.
double Simulation::Implementation::reach_of(std::size_t index) const {
  const Body& body = bodies[index];
  if (!body.can_move) return 0;
  if (parameters.all_bodies_are_dynamic) return std::numeric_limits<double>::infinity();
  double travel = 0;
  for (const auto& device : devices) travel = std::max(travel, device->travel());
  return travel + body.bounds_B.size().norm();  // a body that turns sweeps its own size
}

/// Only what something that moves can come near is voxelized (DESIGN rule 2).
void Simulation::Implementation::voxelize_bodies(const Scene& scene) {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    bool wanted = false;
    for (std::size_t j = 0; j < bodies.size() && !wanted; ++j) {
      if (i == j || !(bodies[i].can_move || bodies[j].can_move)) continue;
      wanted = box_gap(bodies[i], bodies[j]) <= reach_of(i) + reach_of(j);
    }
    if (!wanted) continue;
    const BodyDescription& description = scene.bodies[i];
    VoxelizeOptions options;
    options.voxel_size = description.voxel_size;
    options.point_spacing = description.point_spacing;
    options.threads = threads;
    Part part = merged(description.parts);
    if (!description.use_brep) forget_brep(part);
    auto voxels = std::make_shared<VoxelBody>(voxelize(description.name, part.mesh, options));
    if (bodies[i].hybrid != Hybrid::off && (part.has_brep() || description.declared))
      associate(description.name, part, {.threads = threads, .declared = description.declared.get()}, *voxels);
    bodies[i].voxels = std::move(voxels);
    if (parameters.contact == ContactMethod::fcl) bodies[i].mesh = std::make_unique<MeshTree>(part.mesh);
    make_hybrid(description, bodies[i]);
  }
}

void Simulation::Implementation::make_links() {
  std::vector<BroadPhaseBody> boxes;
  for (const Body& body : bodies) {
    const Vector3d half = 0.5 * body.bounds_B.size() + Vector3d::Constant(grown_by(body));
    boxes.push_back({body.bounds_B.center(), half, body.can_move});
  }
  broad_phase = std::make_unique<BroadPhase>(boxes);
  link_of_pair.assign(bodies.size() * bodies.size(), kNone);
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      if (!(bodies[i].can_move || bodies[j].can_move)) continue;
      link_of_pair[i * bodies.size() + j] = links.size();
      Link link;
      link.first = i;
      link.second = j;
      if (bodies[i].voxels && bodies[j].voxels)
        link.contact = std::make_unique<CollisionLink>(*bodies[i].voxels, *bodies[j].voxels);
      if (link.contact && bodies[i].mesh) link.contact->find_by_triangles(*bodies[i].mesh, *bodies[j].mesh);
      if (link.contact) make_hybrid(link);
      links.push_back(std::move(link));
    }
  for (std::size_t i = 0; i < bodies.size(); ++i) broad_phase->set_pose(i, bodies[i].rigid.pose());
}

}  // namespace verisim
