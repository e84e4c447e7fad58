#include "engine/simulation/stages/motion.hpp"

#include "engine/base/error.hpp"

namespace verisim {

void Motion::advance(World& world, const Response& response, const ExactResponse& exact, const Passivity& passivity,
                     Ledger& ledger) {
  for (const std::size_t i : world.moving) {
    Body& body = world.bodies[i];
    const Loads& loads = response.loads(i);
    work_[i] = exact.solved(i)       ? end_implicit(body.rigid, loads, exact.step(i), exact.velocity_after(i),
                                                    exact.wrench(i), world.dt, &exact.velocity(i))
               : world.is_implicit() ? step_implicit(body.rigid, loads, world.dt, passivity.scale(i))
                                     : step_semi_implicit(body.rigid, loads, world.dt, passivity.scale(i));
    if (exact.solved(i)) work_[i].contact.torque += exact.shift_moment(i);
    if (!body.rigid.is_finite())
      fail(ErrorKind::diverged,
           "frame {}: the state of '{}' is not finite any more; lower the stiffness or the time step", world.frame,
           body.name);
    ledger.add(work_[i]);
  }
}

}  // namespace verisim
