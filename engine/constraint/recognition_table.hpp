// Table 7.1 of the dissertation, measured again: time per pair of entities against how much the engine recognizes.
//
// The published engine had five types of entities (circle, cylinder, cone, plane, sphere) and six recognizers. A choice
// of recognizers was made at compile time, and 20 choices were timed. Here all 64 choices are compiled and timed in one
// run (one function per choice, made by the engine's own multi-method). The task is the published one: two sets with
// one entity of each type, all 25 pairs, the full result by value. No allocation.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/constraint/regression.hpp"

namespace verisim {

/// One choice of recognizers and its time.
struct RecognitionRow {
  int asymmetric = 0;  ///< recognizers of two different types
  int symmetric = 0;   ///< recognizers of one type with itself
  double ns_per_pair = 0;
  [[nodiscard]] int specializations() const { return asymmetric + symmetric; }
  [[nodiscard]] int constraints() const { return 2 * asymmetric + symmetric; }  ///< both orders counted
};

/// The 20 rows of table 7.1 as printed (2.4 GHz Core 2 Duo, GCC 4.6.3).
[[nodiscard]] std::span<const RecognitionRow> published_recognition_rows();

/// Time against each of three counts. Published: R^2 0.7075 and 0.8517; against symmetric ones alone the published rows
/// give 0.901.
struct RecognitionFits {
  Regression constraints, specializations, symmetric;
};
[[nodiscard]] RecognitionFits fit(std::span<const RecognitionRow> rows);

struct RecognitionTable {
  std::vector<RecognitionRow> rows;  ///< 64: bit k of the row's number switches recognizer k on (recognizer_names)
  double bare_visit_ns = 0;          ///< std::visit over the same 25 pairs, a result of the same size by value
  RecognitionFits fits;
};

/// Names of the six published recognizers in the order of the bits.
[[nodiscard]] const std::array<const char*, 6>& recognizer_names();

/// Measures all rows in turn, `rounds` times, and keeps each row's shortest time, because disturbances only lengthen
/// times. Every row's results are checked against the engine's own. Reads the wall clock.
/// Takes about 65 x rounds x ms_per_row. @pre rounds > 0, ms_per_row > 0
[[nodiscard]] RecognitionTable measure_recognition_table(int rounds = 15, double ms_per_row = 1);

}  // namespace verisim
