#include "engine/stability/watch.hpp"

#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim::stability {

Verdict watch(Simulation& simulation, const std::function<double()>& distance, double scale, const Patience& patience) {
  SwingJudge judge(scale, patience);
  std::optional<Outcome> outcome;
  Verdict verdict;
  try {
    while (!outcome) {
      simulation.step();
      simulation.clear_events();
      outcome = judge.take(distance());
    }
  } catch (const Error& error) {
    outcome = error.kind() == ErrorKind::diverged ? Outcome::diverged : Outcome::refused;
    verdict.event = error.what();
  }
  verdict.outcome = *outcome;
  verdict.frames = judge.frames();
  verdict.swing = judge.swing();
  return verdict;
}

std::optional<double> last_stable(double low, double high, double tolerance,
                                  const std::function<bool(double)>& is_stable) {
  VERISIM_ASSERT(is_positive(low));
  VERISIM_ASSERT(is_positive(high));
  VERISIM_ASSERT(low < high);
  VERISIM_ASSERT(is_positive(tolerance));
  if (!is_stable(low) || is_stable(high)) return std::nullopt;
  while (high > low * (1 + tolerance)) {
    const double middle = std::sqrt(low) * std::sqrt(high);
    (is_stable(middle) ? low : high) = middle;
  }
  return std::sqrt(low) * std::sqrt(high);
}

}  // namespace verisim::stability
