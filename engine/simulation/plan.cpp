#include "engine/simulation/plan.hpp"

#include "engine/geometry/merged.hpp"
#include "engine/simulation/body_maker.hpp"
#include "engine/simulation/hybrid_method.hpp"
#include "engine/simulation/world.hpp"
#include "engine/voxel/limits.hpp"

namespace verisim {
namespace {

constexpr std::size_t kMostNamed = 3;

std::string names_of(const World& world, const std::vector<std::size_t>& bodies) {
  std::string text;
  for (std::size_t i = 0; i < std::min(kMostNamed, bodies.size()); ++i)
    text += fmt::format("{}'{}'", i == 0 ? "" : ", ", world.bodies[bodies[i]].name);
  if (bodies.size() > kMostNamed) text += fmt::format(" and {} more", bodies.size() - kMostNamed);
  return text;
}

bool are_near(const Body& a, const Body& b) {
  return gap(world_box(a), world_box(b)) <= grown_by(a) + grown_by(b);
}

void set_when_prepared(const World& world, std::size_t i, BodyPlan& plan) {
  using Prepared = BodyPlan::Prepared;
  if (plan.meets.empty()) {
    plan.why = world.bodies.size() == 1 ? "it is alone" : "nothing that moves can come near it";
    return;
  }
  std::vector<std::size_t> near;
  for (const std::size_t j : plan.meets)
    if (are_near(world.bodies[i], world.bodies[j])) near.push_back(j);
  plan.prepared = near.empty() ? Prepared::near : Prepared::start;
  plan.why = near.empty() ? "may meet " + names_of(world, plan.meets) : "near " + names_of(world, near);
  if (world.hands.empty() || !world.bodies[i].selectable) return;
  plan.prepared = Prepared::start;
  plan.why = "a device may take it; " + plan.why;
}

BodyPlan plan_of_body(const BodyDescription& description, const Body& body) {
  BodyPlan plan;
  plan.name = body.name;
  plan.can_move = body.can_move;
  plan.method = body.method->name();
  plan.mass = body.rigid.mass;
  plan.voxel_size = body.voxel_size;
  for (const Part& part : description.parts) {
    plan.triangles += part.mesh.triangles.size();
    plan.faces += part.faces.size();
  }
  return plan;
}

void set_what_it_takes(const World& world, const BodyDescription& description, BodyPlan& plan, const Body& body) {
  if (plan.prepared == BodyPlan::Prepared::never) return;
  const Part part = merged(description.parts);
  plan.voxel_bytes = MemoryEstimate(part.mesh, bounds_of(part.mesh)).bytes(body.voxel_size);
  const bool has_entities = (description.use_brep && part.has_brep()) || description.declared;
  plan.entities = body.method->needs_entities() && has_entities;
  plan.exact = world.parameters.contact == ContactMethod::voxmap && will_be_exact(description, body.method);
}

}  // namespace

ScenePlan plan_of(const Scene& scene) {
  std::vector<Event> events;
  const World world = make_world(scene, events);
  const BodyMaker maker(scene.bodies, 1, nullptr);
  maker.check(world);
  ScenePlan plan;
  plan.pairs = maker.pairs_that_can_meet(world);
  plan.method = world.parameters.hybrid->name();
  plan.integrator = world.parameters.integrator;
  for (std::size_t i = 0; i < world.bodies.size(); ++i)
    plan.bodies.push_back(plan_of_body(scene.bodies[i], world.bodies[i]));
  for (const auto& [i, j] : plan.pairs) {
    plan.bodies[i].meets.push_back(j);
    plan.bodies[j].meets.push_back(i);
  }
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    set_when_prepared(world, i, plan.bodies[i]);
    set_what_it_takes(world, scene.bodies[i], plan.bodies[i], world.bodies[i]);
  }
  return plan;
}

}  // namespace verisim
