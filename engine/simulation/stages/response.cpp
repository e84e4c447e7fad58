#include "engine/simulation/stages/response.hpp"

#include "engine/simulation/stages/grasping.hpp"

namespace verisim {
namespace {

constexpr double kStabilityBudget = 4;  // dt^2 k lambda + 2 dt b lambda stays below it (contact/penalty.hpp)

void add(Loads& loads, const LinkSide& side) {
  loads.contact += side.wrench;
  loads.contact_stiffness += side.stiffness;
  loads.contact_damping += side.damping;
  loads.contact_drift += side.drift;
}

}  // namespace

Response::Response(const World& world) : bodies_(world.bodies.size()) {}

void Response::pull(const World& world) {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
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
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Body& body = world.bodies[i];
    OfBody& of = bodies_[i];
    of.links_touching = 0;
    of.loads.contact = {};
    of.loads.contact_stiffness.setZero();
    of.loads.contact_damping.setZero();
    of.loads.contact_drift.setZero();
    if (contacts.of_body(i) == 0) continue;
    of.link_body = {body.rigid.pose(), body.rigid.p_WC, {body.rigid.v_C, body.rigid.omega}, Matrix6d::Zero(), 0};
    if (world.moves(body)) of.link_body.inverse_mass = body.rigid.inverse_mass_matrix();
  }
  for (const std::size_t l : world.near_links) {
    if (!contacts.touches(l)) continue;
    ++bodies_[world.links[l].first].links_touching;
    ++bodies_[world.links[l].second].links_touching;
  }
  for (OfBody& of : bodies_) {
    const double left = kStabilityBudget - (of.loads.coupling != nullptr ? of.loads.coupling->budget_used : 0);
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
    add(bodies_[world.links[l].first].loads, sides_[l].first);
    add(bodies_[world.links[l].second].loads, sides_[l].second);
  }
}

void Response::respond(const World& world, std::size_t l, const Contacts& contacts, PairMethod* method) {
  const LinkBody& first = bodies_[world.links[l].first].link_body;
  const LinkBody& second = bodies_[world.links[l].second].link_body;
  CollisionLink& link = contacts.link(l);
  LinkSides& sides = sides_[l];
  const bool implicit = world.is_implicit();
  const SimulationParameters& p = world.parameters;
  // An implicit step takes the other body as going on as it did: of two that move, each would answer with another
  // force. Only against what does not move may the stiffness go beyond the explicit bound.
  const bool stabilize = !implicit || (!first.inverse_mass.isZero(0) && !second.inverse_mass.isZero(0));
  const PenaltyParameters penalty{p.contact_stiffness, p.contact_damping_ratio, stabilize};
  if (method == nullptr) {
    link.respond(first, second, penalty, world.dt);
    link.sum_up(first, second, implicit, sides);
    return;
  }
  const Pose X_AB = contacts.X_AB(world, l);
  if (implicit && method->act_on_normals(link.contacts(), X_AB)) {
    link.respond_at_once(first, second, penalty, world.dt, sides);
  } else {
    link.respond(first, second, penalty, world.dt);
    if (!implicit) method->act_on_forces(link.contacts(), X_AB);
    link.sum_up(first, second, implicit, sides);
  }
  method->act_on_sides(link.contacts(), X_AB, sides);
}

}  // namespace verisim
