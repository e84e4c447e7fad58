// R4: table 7.1 and figure 7.2: time to recognize a pair of entities against the number of recognizers compiled in.
//
// The dissertation timed 20 of the 64 choices of its six recognizers on a 2.4 GHz Core 2 Duo; here all 64 are timed in
// turns, on this machine (constraint/recognition_table.hpp). Absolute times compare two computers and two compilers;
// the regressions compare the method with itself.
#include <fmt/format.h>

#include <algorithm>

#include "engine/constraint/recognition_table.hpp"
#include "engine/record/output_place.hpp"
#include "engine/reproduce/reproductions.hpp"

namespace verisim::reproduce {
namespace {

constexpr int kAll = 6;  ///< recognizers

/// Mean time of the rows with this many specializations.
double mean_ns(std::span<const RecognitionRow> rows, int specializations) {
  double sum = 0;
  int count = 0;
  for (const RecognitionRow& row : rows) {
    if (row.specializations() != specializations) continue;
    sum += row.ns_per_pair;
    ++count;
  }
  return sum / count;
}

std::string csv_of(const RecognitionTable& table) {
  std::string csv = "recognizers,asymmetric,symmetric,specializations,constraints,ns_per_pair\n";
  for (std::size_t mask = 0; mask < table.rows.size(); ++mask) {
    std::string names;
    for (std::size_t bit = 0; bit < recognizer_names().size(); ++bit)
      if ((mask >> bit & 1U) != 0) names += (names.empty() ? "" : "+") + std::string(recognizer_names()[bit]);
    const RecognitionRow& row = table.rows[mask];
    csv += fmt::format("{},{},{},{},{},{:.4f}\n", names.empty() ? "none" : names, row.asymmetric, row.symmetric,
                       row.specializations(), row.constraints(), row.ns_per_pair);
  }
  return csv;
}

std::string by_specializations(std::span<const RecognitionRow> rows) {
  std::string text;
  for (int n = 0; n <= kAll; ++n) text += fmt::format("{}{:.1f}", n == 0 ? "" : ", ", mean_ns(rows, n));
  return text;
}

}  // namespace

std::vector<Row> r4_recognition(const Workshop& workshop) {
  const RecognitionTable table = workshop.quick ? measure_recognition_table(5, 0.5) : measure_recognition_table();
  const std::span<const RecognitionRow> published = published_recognition_rows();
  const RecognitionFits then = fit(published);
  const std::string file = workshop.file("r4_recognition.csv");
  write_text(file, csv_of(table), workshop.force);

  const auto row = [&](const char* what, const char* unit, double was, double is, std::string why) {
    return Row{"R4", what, unit, was, is, {}, std::move(why), {file}};
  };
  return {
      row("recognition of a pair, no recognizer", "ns", mean_ns(published, 0), mean_ns(table.rows, 0),
          fmt::format(
              "with no recognizer the compiler leaves nothing to dispatch; std::visit over the same pairs with a "
              "full result by value takes {:.1f} ns",
              table.bare_visit_ns)),
      row("recognition of a pair, all six recognizers", "ns", mean_ns(published, kAll), mean_ns(table.rows, kAll),
          fmt::format(
              "most pairs are told apart without a call; mean ns for 0 to 6 specializations over all 64 choices: "
              "{}",
              by_specializations(table.rows))),
      row("R2 of time against constraints (fig. 7.2a)", "", then.constraints.r_squared,
          table.fits.constraints.r_squared,
          "without the cost of a visitor each filled cell of the table is paid for, and a recognizer of two types "
          "fills "
          "two: here reversed arguments are not free, which fig. 7.2 concluded from 20 of the 64 choices"),
      row("R2 of time against specializations (fig. 7.2b)", "", then.specializations.r_squared,
          table.fits.specializations.r_squared, "the same: the count that is right explains more, the other less"),
      row("R2 of time against symmetric specializations", "", then.symmetric.r_squared, table.fits.symmetric.r_squared,
          "not in the dissertation, whose own rows the symmetric ones alone explain best; not so when all 64 are "
          "timed"),
  };
}

}  // namespace verisim::reproduce
