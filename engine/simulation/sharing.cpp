// What contacts that a method changed may do within a step, and what all contacts have done at its end.
#include <algorithm>

#include "engine/simulation/groups.hpp"

namespace verisim {

Wrench reaction(const Wrench& wrench, const Body& on, const Body& other) {
  const Vector3d arm = on.p_WC_found - other.p_WC_found;
  return {-wrench.force, -(wrench.torque + arm.cross(wrench.force))};
}

/// Bodies that move and touch each other are one group, which goes by its first body. One that the exact response moves
/// is alone: it has no share.
void Simulation::Implementation::join_groups() {
  const auto shares = [&](std::size_t body) { return moves(bodies[body]) && !bodies[body].solved; };
  join_bodies(bodies, links, &Body::group,
              [&](const Link& link) { return link.touches() && shares(link.first) && shares(link.second); });
}

/// The contacts of a group with a changed one give no more energy than all contacts were given (integrator.hpp).
void Simulation::Implementation::share_contacts() {
  bool any = false;
  for (Body& body : bodies) {
    body.loads.contact_scale = 1;
    any = any || body.reshaped;
  }
  if (!any || !parameters.passive_contacts) return;
  join_groups();
  for (Body& body : bodies) {
    body.contact_work = {};
    bodies[body.group].reshaped |= body.reshaped;
  }
  for (const Body& body : bodies) {
    if (!bodies[body.group].reshaped || !moves(body) || body.solved) continue;
    bodies[body.group].contact_work += parameters.integrator == Integrator::implicit
                                           ? contact_work_implicit(body.rigid, body.loads, dt)
                                           : contact_work_semi_implicit(body.rigid, body.loads, dt);
  }
  double budget = ledger.contact();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Body& body = bodies[i];
    Loads& of_first = bodies[body.group].loads;
    if (body.group == i && body.reshaped) {
      of_first.contact_scale = passive_scale(std::max(0.0, budget), body.contact_work);
      budget -= body.contact_work.at(of_first.contact_scale);
    }
    body.loads.contact_scale = of_first.contact_scale;
  }
}

/// What the voxels' contacts of a link did to one of its bodies. To one that stands still they did what the reaction
/// is of what they did to the other; where both stand still, what they would have done.
Wrench Simulation::Implementation::applied(const LinkSide& mine, const Body& body, const LinkSide& theirs,
                                           const Body& other) const {
  const auto on = [&](const LinkSide& side, const ContactEnd& end) {
    return wrench_at_end(side.wrench, side.stiffness, side.damping, side.drift, end, dt);
  };
  if (moves(body)) return on(mine, body.contact_end);
  if (!moves(other)) return mine.wrench;
  const bool at_start = parameters.integrator == Integrator::semi_implicit && !other.solved;
  return at_start ? on(mine, other.contact_end) : reaction(on(theirs, other.contact_end), other, body);
}

/// Writes down what every contact has done, now that the bodies have moved.
void Simulation::Implementation::tell_contacts() {
  for (Body& body : bodies)
    if (!moves(body)) body.contact_wrench = {};
  for (Link& link : links) {
    Body& first = bodies[link.first];
    Body& second = bodies[link.second];
    Wrench on_first = reaction(link.on_second, second, first);
    if (link.touches()) {
      on_first += applied(link.first_side, first, link.second_side, second);
      link.on_second += applied(link.second_side, second, link.first_side, first);
    }
    if (!moves(first)) first.contact_wrench += on_first;
    if (!moves(second)) second.contact_wrench += link.on_second;
  }
}

}  // namespace verisim
