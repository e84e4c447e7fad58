// How far a figure may move before it counts: bench/baseline/bounds.json, which is built into the program and says of
// each bound where it comes from.
#pragma once

#include <map>
#include <string>

#include "engine/compare/comparison.hpp"

namespace verisim::compare {

struct Bound {
  double relative = 0, absolute = 0;  ///< allowed is the larger of the absolute one and the relative one of A's value
  bool less_is_better = false;        ///< else neither is
  std::string source;
};

struct Bounds {
  std::map<std::string, Bound> figures;  ///< by the figure's name; "measure" is that of what scenarios measure
  double effect_interleaved = 0;         ///< of times that were taken in turns
  double effect_apart = 0;               ///< of times that were taken one after the other
  double flips = 0;                      ///< fraction of a batch's runs that may have another outcome

  /// A and B under the bound of `name`, or of "measure" if it has none of its own. Equal to the bit is `none`; so is
  /// what stays within the bound, with a note.
  [[nodiscard]] AccuracyFigure judge(const std::string& name, double a, double b) const;
};

/// Those that the program was built with.
[[nodiscard]] const Bounds& built_in_bounds();

/// @param name  what errors call the text
/// Error(input): not JSON, a bound without a source, a number below 0.
[[nodiscard]] Bounds read_bounds(const std::string& name, const std::string& text);

}  // namespace verisim::compare
