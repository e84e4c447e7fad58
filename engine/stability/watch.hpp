// Runs a simulation until the motion of one coordinate is judged.
#pragma once

#include <functional>
#include <string>

#include "engine/simulation/simulation.hpp"
#include "engine/stability/outcome.hpp"

namespace verisim::stability {

struct Verdict {
  Outcome outcome = Outcome::stable;
  std::uint64_t frames = 0;  ///< looked at
  double swing = 0;          ///< of the last block, in the coordinate's unit
  std::string event;         ///< what the engine said of it: why it was refused or ended; else empty
};

/// @param distance  from rest, asked after every frame  @param scale  of the disturbance  @pre as SwingJudge has it
[[nodiscard]] Verdict watch(Simulation& simulation, const std::function<double()>& distance, double scale,
                            const Patience& patience);

/// The largest value for which `is_stable` holds, between `low` (it does) and `high` (it does not), by bisection of the
/// logarithm, to `tolerance` (relative). Nothing if it holds at neither end or at both.
/// @pre 0 < low < high, tolerance > 0
[[nodiscard]] std::optional<double> last_stable(double low, double high, double tolerance,
                                                const std::function<bool(double)>& is_stable);

}  // namespace verisim::stability
