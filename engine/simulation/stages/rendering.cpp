#include "engine/simulation/stages/rendering.hpp"

#include <algorithm>

namespace verisim {
namespace {

Vector3d within(double norm_max, const Vector3d& v) {
  const double norm = v.norm();
  return norm > norm_max ? Vector3d(norm_max / norm * v) : v;
}

/// The reaction to the coupling, about the virtual handle. The damper of a heavy body is more than a hand at the end of
/// a sampled loop can bear: b dt/m_hand, with the arm's part, has to stay below 1 (half of the bound in ORACLES section
/// 2). The lightest hand with its handle is taken as 0.1 kg and 0.001 kg m^2; beyond that the damper, which is there
/// for the body's sake, is rendered weaker. The spring is rendered in full; nothing beyond the coupling's limits.
Wrench felt(const Vector3d& handle, const Coupling& coupling, const CouplingTarget& target, const StepWork& work,
            double dt) {
  constexpr double kMass = 0.1;
  constexpr double kInertia = 0.001;
  const Vector3d arm = target.p_WC - handle;
  const double linear = dt * coupling.damping * (1 / kMass + arm.squaredNorm() / kInertia);
  const double angular = dt * coupling.angular_damping_B.trace() / kInertia;
  const Vector3d force =
      within(coupling.force_max, work.coupling.force - (1 - std::min(1.0, 1 / linear)) * work.coupling_damper.force);
  const Vector3d torque = within(coupling.torque_max,
                                 work.coupling.torque - (1 - std::min(1.0, 1 / angular)) * work.coupling_damper.torque);
  return {-force, -torque - arm.cross(force)};
}

}  // namespace

void render(const World& world, const Response& response, const Motion& motion) {
  for (const Hand& hand : world.hands) {
    Wrench wrench;
    if (hand.body != kNone)
      wrench = felt(hand.device->reading().handle.position, world.bodies[hand.body].coupling,
                    response.loads(hand.body).target, motion.work(hand.body), world.dt);
    hand.device->render(wrench, world.dt);
  }
}

}  // namespace verisim
