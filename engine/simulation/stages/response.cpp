#include "engine/simulation/stages/response.hpp"

#include "engine/base/error.hpp"
#include "engine/simulation/stages/grasping.hpp"

namespace verisim {
namespace {

/// @param mutual  both bodies of the link move
void add(Loads& loads, const LinkSide& side, bool mutual) {
  (mutual ? loads.contact_mutual : loads.contact) += side.wrench;
  loads.contact_stiffness += side.stiffness;
  loads.contact_damping += side.damping;
  loads.contact_drift += side.drift;
}

/// Are the link's contacts taken at the start of the step, and their stiffness limited? An implicit step takes the
/// other body as it is: two that move would each answer with another force (dynamics/integrator.hpp).
bool is_explicit(const World& world, std::size_t l) {
  const Link& link = world.links[l];
  return !world.is_implicit() || (world.moves(world.bodies[link.first]) && world.moves(world.bodies[link.second]));
}

}  // namespace

Response::Response(const World& world) : bodies_(world.bodies.size()) {}

void Response::pull(const World& world) {
  for (const std::size_t i : world.busy) {
    const Body& body = world.bodies[i];
    Loads& loads = bodies_[i].loads;
    loads.external = {};
    loads.coupling = nullptr;
    if (!body.can_move) continue;
    if (world.parameters.all_bodies_are_dynamic) loads.external.force = body.rigid.mass * world.parameters.gravity;
    if (body.held_by == kNone) continue;
    loads.coupling = &body.coupling;
    loads.target = target_of(world, body.held_by);
    loads.coupling_at_start = coupling_force(body.coupling, body.rigid, loads.target);
  }
}

void Response::prepare_bodies(const World& world, const Contacts& contacts) {
  for (const std::size_t i : world.busy) {
    const bool touches = contacts.of_body(i) > 0;
    OfBody& of = bodies_[i];
    if (!touches && !of.touched) continue;  // all is zero as it was
    of.touched = touches;
    const Body& body = world.bodies[i];
    of.links_touching = 0;
    of.loads.contact = {};
    of.loads.contact_mutual = {};
    of.loads.contact_stiffness.setZero();
    of.loads.contact_damping.setZero();
    of.loads.contact_drift.setZero();
    if (!touches) continue;
    of.link_body = {
        body.rigid.pose(), body.rigid.p_WC, {body.rigid.v_C, body.rigid.omega}, Matrix6d::Zero(), kStabilityBudget};
    if (world.moves(body)) of.link_body.inverse_mass = body.rigid.inverse_mass_matrix();
  }
  for (const std::size_t l : world.near_links) {
    if (!contacts.touches(l) || !is_explicit(world, l)) continue;
    ++bodies_[world.links[l].first].links_touching;
    ++bodies_[world.links[l].second].links_touching;
  }
  for (const std::size_t i : world.busy) {
    OfBody& of = bodies_[i];
    const double left = kStabilityBudget - (of.loads.coupling != nullptr ? of.loads.coupling->budget_used : 0);
    VERISIM_ASSERT(left > 0);
    if (of.links_touching > 0) of.link_body.budget = left / of.links_touching;
  }
}

void Response::respond(const World& world, const Contacts& contacts, const PairMethods& methods, FrameCost& cost) {
  prepare_bodies(world, contacts);
  for (const std::size_t l : world.near_links) {
    if (!contacts.touches(l)) continue;
    respond(world, l, contacts, methods.acting(l));
    const LookUps found = methods.look_ups(l);
    cost.lookups += found.hits + found.misses;
    cost.recognitions += found.recognitions;
    cost.memo_overflows += found.overflows;
    const bool mutual = world.is_implicit() && is_explicit(world, l);
    add(bodies_[world.links[l].first].loads, sides_[l].first, mutual);
    add(bodies_[world.links[l].second].loads, sides_[l].second, mutual);
  }
}

void Response::respond(const World& world, std::size_t l, const Contacts& contacts, PairMethod* method) {
  const LinkBody& first = bodies_[world.links[l].first].link_body;
  const LinkBody& second = bodies_[world.links[l].second].link_body;
  CollisionLink& link = contacts.link(l);
  LinkSides& sides = sides_[l];
  const SimulationParameters& p = world.parameters;
  const bool at_start = is_explicit(world, l);
  const PenaltyParameters penalty{p.contact_stiffness, p.contact_damping_ratio, at_start && p.stability_rule,
                                  p.passive_contacts};
  const Pose X_AB = contacts.X_AB(world, l);
  if (method != nullptr) method->act_on_normals(link.contacts(), X_AB);
  if (at_start) {
    link.respond(first, second, penalty, world.dt);
    if (method != nullptr) method->act_on_forces(link.contacts(), X_AB);
    link.sum_up(first, second, sides);
  } else {
    link.respond_at_once(first, second, penalty, world.dt, sides);
  }
  if (method != nullptr) method->act_on_sides(link.contacts(), X_AB, sides);
}

}  // namespace verisim
