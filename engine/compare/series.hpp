// Repetitions of two programs, taken in turns: who runs first in each pair, and what a pair measured.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/compare/times.hpp"

namespace verisim::compare {

/// Whether B runs first in the pair. Drawn by a named stream, so that no drift and no rhythm of the machine is always
/// on one side, and the test's p is exact by the lot alone.
[[nodiscard]] bool is_b_first(std::uint64_t seed, std::uint64_t pair);

/// One run's times, in the order of SeriesFigure.
using RunTimes = std::vector<double>;

struct SeriesFigure {
  std::string name, unit;
};

/// Times of A and B by pairs.
class Series {
 public:
  explicit Series(std::vector<SeriesFigure> figures) : figures_(std::move(figures)) {}
  /// @pre as many times as figures
  void add_pair(const RunTimes& a, const RunTimes& b);
  [[nodiscard]] std::size_t pairs() const { return a_.size(); }
  [[nodiscard]] std::vector<TimeSamples> samples() const;

 private:
  std::vector<SeriesFigure> figures_;
  std::vector<RunTimes> a_, b_;
};

}  // namespace verisim::compare
