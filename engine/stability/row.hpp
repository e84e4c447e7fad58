// What is computed, as rows: a cell or a bound of a map, an extreme, a ledger. Every row is a task of its own that
// depends on nothing else, so that the order and the place in which they are computed do not matter.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/stability/outcome.hpp"

namespace verisim::stability {

struct Figure {
  std::string name, unit;
  double value;
};

struct Row {
  std::string what;
  Outcome outcome = Outcome::stable;
  std::string theory;  ///< the formula, or what was expected
  bool holds = true;   ///< what theory or promise says
  std::string why;     ///< where it does not hold, and why; or what the engine said
  std::vector<Figure> figures;

  /// A failure of which nobody is told.
  [[nodiscard]] bool is_silent() const { return !holds && why.empty(); }

  /// A figure's value by name; nothing if the row has none.
  [[nodiscard]] std::optional<double> figure(const std::string& name) const;
};

enum class RowKind : std::uint8_t { cell, bound, extreme, ledger };

struct Task {
  std::string map;  ///< whose cell or bound it is; else empty
  RowKind kind = RowKind::cell;
  std::string what;                ///< as Row::what
  bool is_long = false;            ///< only computed when all is asked for
  std::function<Row()> compute{};  ///< deterministic
};

/// A map: which two figures span it, and what it shows.
struct MapDescription {
  std::string name, title, theory;
  std::string x, y, panel;  ///< names of the figures; a picture per value of `panel`
};

}  // namespace verisim::stability
