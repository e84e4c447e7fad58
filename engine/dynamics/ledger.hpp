// Energy ledger: where every joule of a run came from and went to. All in J, summed since the start over all bodies.
//
//   kinetic + coupling + gravity + dissipated + contact + numerical = input + (their sum at the start)
//
// kinetic, coupling (springs of the virtual couplings) and gravity are computed from the state, the latter two as the
// integrator keeps them (shadow_energy in integrator.hpp); dissipated (couplings' dampers and clutches), contact (given
// to contacts: stored in penalty springs and lost in their dampers and in the steps between voxels) and input (hand)
// are works: force times dt times the mean of the velocities before and after, which is exactly what a force does to
// kinetic energy. `numerical` is what the time discretization lost: a potential's force times that mean displacement
// against the change of the potential, as kept, along the real one, and the turning of I at constant angular momentum.
// What is left over is rounding: `residual`.
#pragma once

#include "engine/dynamics/integrator.hpp"

namespace verisim {

struct EnergyState {
  double kinetic = 0, coupling = 0, gravity = 0;
  [[nodiscard]] double sum() const { return kinetic + coupling + gravity; }
};

class Ledger {
 public:
  /// Starts with what is there. Also resets.
  void start(const EnergyState& state) {
    *this = Ledger();
    start_ = state.sum();
  }
  void add(const StepWork& work);
  /// A change that no load made: the hand moved the handle and so stretched the spring; a grasp, a release; a body that
  /// a script put elsewhere.
  void add_jump(double energy) { input_ += energy; }

  [[nodiscard]] double dissipated() const { return dissipated_; }
  [[nodiscard]] double contact() const { return contact_; }
  [[nodiscard]] double input() const { return input_; }
  [[nodiscard]] double numerical() const { return numerical_; }
  [[nodiscard]] double residual(const EnergyState& now) const {
    return now.sum() + dissipated_ + contact_ + numerical_ - input_ - start_;
  }

 private:
  double start_ = 0, dissipated_ = 0, contact_ = 0, input_ = 0, numerical_ = 0;
};

}  // namespace verisim
