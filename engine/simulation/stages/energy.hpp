// Energies of a world, as the ledger counts them (dynamics/ledger.hpp).
#pragma once

#include "engine/dynamics/ledger.hpp"
#include "engine/simulation/world.hpp"

namespace verisim {

[[nodiscard]] EnergyState energy_of(const World& world);
/// J, of the coupling that holds a body. 0: nobody holds it.
[[nodiscard]] double spring_energy_of(const World& world, const Body& body);

class EnergyBook {
 public:
  explicit EnergyBook(const World& world) : state_(energy_of(world)) { ledger_.start(state_); }

  /// Before a step: whatever changed the energy since the last one's end was the hand (it moved the handle), a grasp or
  /// a script.
  void enter_jump(const World& world) { ledger_.add_jump(energy_of(world).sum() - state_.sum()); }
  /// After a step.
  void settle(const World& world) { state_ = energy_of(world); }

  [[nodiscard]] Ledger& ledger() { return ledger_; }
  [[nodiscard]] const Ledger& ledger() const { return ledger_; }
  [[nodiscard]] const EnergyState& state() const { return state_; }

 private:
  EnergyState state_;
  Ledger ledger_;
};

}  // namespace verisim
