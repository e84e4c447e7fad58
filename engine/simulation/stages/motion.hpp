// One step of every body that moves, from its loads; and what that step did.
#pragma once

#include <vector>

#include "engine/base/error.hpp"
#include "engine/dynamics/ledger.hpp"
#include "engine/simulation/stages/passivity.hpp"

namespace verisim {

class Motion {
 public:
  explicit Motion(const World& world) : work_(world.bodies.size()) {}

  /// Error(diverged) with frame and body if a state stops being finite.
  void advance(World& world, const Response& response, const ExactResponse& exact, const Passivity& passivity,
               Ledger& ledger);
  /// Of a body that has never moved: nothing. @pre there is such a body
  [[nodiscard]] const StepWork& work(std::size_t body) const {
    VERISIM_ASSERT(body < work_.size());
    return work_[body];
  }

 private:
  std::vector<StepWork> work_;
};

}  // namespace verisim
