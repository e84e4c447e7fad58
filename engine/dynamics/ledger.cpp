#include "engine/dynamics/ledger.hpp"

namespace verisim {

void Ledger::add(const StepWork& work) {
  dissipated_ += work.damper;
  contact_ -= work.contact_work;
  input_ += work.input;
  numerical_ += work.numerical;
}

}  // namespace verisim
