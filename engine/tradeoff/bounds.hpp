// What a user asks of a setting, and which one answers it.
#pragma once

#include <optional>
#include <string>

#include "engine/tradeoff/table.hpp"

namespace verisim::tradeoff {

/// An error of this kind is at most so large.
struct ErrorBound {
  Kind kind = Kind::force;
  double most = 0;  ///< in the kind's unit
};

struct Bounds {
  std::optional<double> budget_us;  ///< of the median frame with contact
  std::optional<ErrorBound> error;
};

/// A number with a unit: "200us", "0.05N", "0.01mm", "1e-3 N m", "0.5deg", "5%", "0.05". SI prefixes from pico to giga.
struct Quantity {
  double value = 0;  ///< SI
  std::string unit;  ///< "s", "N", "N m", "m", "rad", "J", "1"
};
/// Error(usage) that begins with `what`.
[[nodiscard]] Quantity quantity_from(const std::string& what, const std::string& text);

/// A time above 0, as us. Error(usage).
[[nodiscard]] double budget_from(const std::string& what, const std::string& text);
/// The kind of that name. Error(usage) that lists them.
[[nodiscard]] Kind kind_named(const std::string& what, const std::string& name);
/// By the unit: N is `force`, N m `torque`, m `overlap`, rad `rotation`, J `work`, none or % `wrench`; `by`, if not
/// empty, names another kind of that unit. Error(usage): no such unit, kind and unit do not go together, not above 0.
[[nodiscard]] ErrorBound error_bound_from(const std::string& what, const std::string& text, const std::string& by);

/// What makes one of several rows that keep the bounds the better answer: least load if an error is bounded, else the
/// least error; or the least error in any case, as far from the bound as can be.
enum class Prefer { cheapest, most_accurate };

/// The row that keeps the bounds: with an error bound the one of least load, else the most accurate by `by`. A bound is
/// held against what a row had at worst: the greatest time and the greatest error of its repetitions. Of equal rows
/// the first; none: no row keeps them.
[[nodiscard]] std::optional<std::size_t> choose(const std::vector<Row>& rows, const Bounds& bounds, Kind by,
                                                Prefer prefer = Prefer::cheapest);

/// "bounds that all 3 repetitions kept are expected to hold in 75 % of further trials": of a setting, of its error and
/// its time together, for of n + 1 trials each is as likely to be the one that does not. With what makes it 95 % where
/// it is less. (Not of `flips`, which is a share of the repetitions.)
[[nodiscard]] std::string coverage_text(std::uint64_t repetitions);
inline constexpr double kWantedCoverage = 0.95;

/// "a median frame of at most 200 us, an error of force of at most 0.05 N".
[[nodiscard]] std::string text_of(const Bounds& bounds);

}  // namespace verisim::tradeoff
