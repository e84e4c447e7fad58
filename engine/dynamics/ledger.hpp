// Energy ledger: an account of all energy in a run. All in J, summed since the start over all bodies.
//
//   kinetic + coupling + gravity + dissipated + contact + numerical = input + (their sum at the start)
//
// From the state: kinetic; coupling (springs of the virtual couplings) and gravity, as the integrator conserves them
// (shadow_energy in integrator.hpp).
// Works: dissipated (dampers and clutches of couplings); contact (given to contacts: stored in penalty springs, lost in
// their dampers and in the steps between voxels); input (by the hand). A work is force times dt times the mean of the
// velocities before and after, which is exactly the change of kinetic energy by that force.
// numerical: energy lost by the time discretization. It is the work of potential forces along the mean displacement,
// against the change of the potentials along the real one, plus the effect of a turning I at constant angular momentum.
// residual: the rest, which is rounding.
#pragma once

#include "engine/dynamics/integrator.hpp"

namespace verisim {

struct EnergyState {
  double kinetic = 0, coupling = 0, gravity = 0;
  [[nodiscard]] double sum() const { return kinetic + coupling + gravity; }
};

class Ledger {
 public:
  /// Resets all sums; the present energy is the start.
  void start(const EnergyState& state) {
    *this = Ledger();
    start_ = state.sum();
  }
  void add(const StepWork& work);
  /// Adds a change of energy that no load made: the handle moved and stretched the spring; a grasp or a release; a
  /// script moved a body.
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
