#include "engine/device/hand/arm.hpp"

#include <algorithm>

namespace verisim {

// The handle's friction is part of the same step: it takes what momentum there is, and never turns it round.
void Arm::pull(const Pose& aim, const Wrench& felt, double dt) {
  const HandDescription& h = hand_;
  const double mass = h.mass + load_.mass;
  const Vector3d before = v_;
  const auto rubbed = [&](Vector3d momentum) {
    if (load_.friction > 0) {
      const double length = momentum.norm();
      momentum *= length > 0 ? std::max(0.0, 1 - dt * load_.friction / length) : 0;
    }
    return momentum;
  };
  const Vector3d momentum = rubbed(mass * v_ + dt * (h.stiffness * (aim.position - x_) + felt.force));
  v_ = momentum / (mass + dt * h.damping + dt * dt * h.stiffness);
  if (std::isfinite(force_max_)) {
    // What the muscles do at the end of the step. Too much for them: the greatest force they have, in that direction.
    const Vector3d muscles = h.stiffness * (aim.position - x_ - dt * v_) - h.damping * v_;
    const double force = muscles.norm();
    if (force > force_max_) v_ = rubbed(mass * before + dt * (force_max_ / force * muscles + felt.force)) / mass;
  }
  x_ += dt * v_;
  keep_within_reach();
  const Vector3d e = vector_from_rotation(aim.rotation * q_.conjugate());
  w_ = (h.inertia * w_ + dt * (h.angular_stiffness * e + felt.torque)) /
       (h.inertia + dt * h.angular_damping + dt * dt * h.angular_stiffness);
  q_ = (rotation_from_vector(dt * w_) * q_).normalized();
}

/// travel() is a promise: whatever pushes, the arm ends there. The outward velocity is lost.
void Arm::keep_within_reach() {
  const Vector3d out = x_ - start_;
  const double distance = out.norm();
  if (!(distance > reach_)) return;
  const Vector3d n = out / distance;
  x_ = start_ + reach_ * n;
  v_ -= std::max(0.0, v_.dot(n)) * n;
}

}  // namespace verisim
