// Are the times of B longer than those of A? Each figure gets a ratio, an interval and a p; the decision takes both:
// the difference has to be sure (p, corrected for how many figures are judged, below alpha) and worth a word (the
// ratio beyond the figure's bound). The first alone calls every difference of 0.1 % a regression once there are
// repetitions enough; the second alone calls noise one. Its rates of error: rates.hpp.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace verisim::compare {

inline constexpr double kLevel = 0.95;  ///< of intervals

/// When a difference counts.
struct TimeRule {
  double effect = 0;  ///< by how much B has to be slower, or A slower than B: 0.025 is 2.5 %
  double alpha = 0;   ///< how likely chance alone may be, all judged figures of a comparison together
};
/// Runs in turns: half of the 1 % of false alarms that is promised, for recorded times are not as kind as the theory's.
inline constexpr double kAlphaInTurns = 0.005;
/// One series after the other, where the machine's drift is no chance and no test sees it (rates.hpp tells what it
/// does).
inline constexpr double kAlphaApart = 0.01;

enum class TimeChange { none, faster, slower, unknown };

/// The times of one figure under A and under B, in its unit.
struct TimeSamples {
  std::string name, unit;
  std::vector<double> a{}, b{};
  bool is_paired = false;  ///< the i-th of A and of B were taken together
  bool is_judged = true;   ///< else it is only shown
};

struct TimeFigure {
  std::string name, unit;
  std::size_t count_a = 0, count_b = 0;
  double median_a = 0, median_b = 0;
  double ratio = 1;                     ///< B by A: Hodges and Lehmann's
  std::optional<double> low{}, high{};  ///< its 95 % interval; none: too few to bound it
  std::optional<double> p{};            ///< not corrected; none: one repetition
  TimeChange change = TimeChange::unknown;
  bool is_judged = true;
  std::string note{};  ///< why there is no verdict, or empty
};

/// @pre samples are above 0 and finite, none is empty; of pairs, as many of a as of b; 0 <= effect, 0 < alpha < 1
[[nodiscard]] std::vector<TimeFigure> judge_times(std::span<const TimeSamples> samples, const TimeRule& rule);

}  // namespace verisim::compare
