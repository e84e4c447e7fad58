// `verisim compare --programs A B -- ARGS`: two builds of verisim run with the same arguments, in turns.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/compare/comparison.hpp"

namespace verisim::cli {

struct ProgramsAsked {
  std::string a, b;
  std::vector<std::string> arguments;
  std::size_t runs = 0;    ///< of each, after the first of each, which is left out
  std::uint64_t seed = 0;  ///< of who runs first in each pair
  std::string times_file;  ///< every time that was taken, as CSV; empty: nowhere
  bool force = false;      ///< `times_file` may replace a file of another kind
  bool quiet = false;
};

/// Runs both programs; where ARGS begin with `run`, each writes a run file of its own, whose counts, accuracy and
/// outcomes are compared as those of two files.
/// Error(input): a program cannot be started or does not end with 0. Error(interrupted).
[[nodiscard]] compare::Comparison compare_programs(const ProgramsAsked& asked);

}  // namespace verisim::cli
