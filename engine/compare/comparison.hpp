// What two runs, batches or benchmark files differ in, and the verdict: what `verisim compare` prints (INTERFACES
// section 5). Whoever compares says of each difference which way it goes; the verdict follows from those alone.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "engine/compare/times.hpp"

namespace verisim::compare {

/// Which way B differs from A.
enum class Change {
  none,
  better,   ///< cheaper, faster, more accurate
  worse,    ///< costlier, slower, less accurate
  changed,  ///< neither: another word, another number of frames; what was only in one of them
  bits      ///< other bits of which no judged figure tells
};

/// A whole number stays one. Nothing: only the other has it.
using Value = std::variant<std::monostate, std::uint64_t, double, std::string>;

/// A figure of which A and B have different values, and must not.
struct CountDifference {
  std::string name;
  Value a, b;
  Change change = Change::changed;
  std::string note{};
};

struct AccuracyFigure {
  std::string name;
  Value a, b;
  std::optional<double> bound;  ///< they may differ by so much; none: this figure is only shown
  Change change = Change::none;
  std::string note{};
};

struct OutcomeFigure {
  std::string name;
  Value a, b;  ///< words; of batches how many runs
  Change change = Change::none;
  std::string note{};
};

/// Where A or B comes from.
struct Origin {
  std::string path, version, commit;
};

struct Comparison {
  std::string kind;  ///< "runs", "batches", "benchmarks", "programs"
  Origin a, b;
  std::size_t counts_compared = 0;
  std::vector<CountDifference> counts{};  ///< those that differ
  std::vector<AccuracyFigure> accuracy{};
  std::vector<OutcomeFigure> outcomes{};
  std::vector<TimeFigure> times{};
  std::vector<std::string> only_a{}, only_b{};  ///< benchmarks, runs, datasets that the other lacks
  std::string first_difference{};      ///< "frame 1201, /state/body/pin/twist[3]: ..."; empty: none, or not looked for
  std::vector<std::string> notices{};  ///< what the reader has to know: other parameters, another CPU
};

enum class Verdict { same, better, worse, different };

/// `different`: something is neither better nor worse, or some is better and some worse. `worse`: something is, and
/// nothing is better.
[[nodiscard]] Verdict verdict_of(const Comparison& comparison);
[[nodiscard]] const char* name_of(Verdict verdict);

/// "2 counts are higher", "'max_force_N' is beyond its bound": what the verdict comes from, the worst first.
[[nodiscard]] std::vector<std::string> reasons_of(const Comparison& comparison);

}  // namespace verisim::compare
