#include "engine/simulation/stages/energy.hpp"

#include "engine/simulation/stages/grasping.hpp"

namespace verisim {

double spring_energy_of(const World& world, const Body& body) {
  if (body.held_by == kNone) return 0;
  return coupling_energy(body.coupling, coupling_force(body.coupling, body.rigid, target_of(world, body.held_by)));
}

EnergyState energy_of(const World& world) {
  const double shadow_dt = world.is_implicit() ? 0 : world.dt;
  EnergyState e;
  for (const std::size_t i : world.moving) {
    const Body& body = world.bodies[i];
    e.kinetic += body.rigid.kinetic_energy();
    if (world.parameters.all_bodies_are_dynamic) {
      const Vector3d weight = body.rigid.mass * world.parameters.gravity;
      e.gravity += shadow_energy({weight, Vector3d::Zero()}, body.rigid, shadow_dt) - weight.dot(body.rigid.p_WC);
    }
    if (body.held_by == kNone) continue;
    const CouplingForce pull = coupling_force(body.coupling, body.rigid, target_of(world, body.held_by));
    e.coupling += coupling_energy(body.coupling, pull) + shadow_energy(pull.spring, body.rigid, shadow_dt);
  }
  return e;
}

}  // namespace verisim
