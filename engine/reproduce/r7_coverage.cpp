// R7: the trackable area and volume of a Wii Remote, eq. 2.1 and 2.2, beside a count with the virtual one.
//
// The dissertation gives the equations and the field of view, no numbers: `published` is what the printed equations
// give for its 43 x 32 degrees and LEDs 0.15 m apart. `here` is counted and uses neither equation.
#include <array>

#include "engine/base/error.hpp"
#include "engine/record/output_place.hpp"
#include "engine/reproduce/reproductions.hpp"
#include "engine/wii/coverage.hpp"

namespace verisim::reproduce {
namespace {

constexpr double kSpacing = 0.15;                               ///< m, section 2.8
constexpr std::array<double, 4> kDistances = {0.4, 1, 1.5, 2};  ///< m, the range in which glasses are worn
constexpr std::uint64_t kSeed = 1;
constexpr double kNormal95 = 1.959964;  ///< 97.5 % point of the normal distribution

void enter(Row& row, const wii::Counted& counted) {
  row.here = counted.value;
  row.interval = {counted.value - kNormal95 * counted.standard_error,
                  counted.value + kNormal95 * counted.standard_error};
}

double off_by(const wii::Counted& counted, double value) {
  return (counted.value - value) / counted.standard_error;
}

}  // namespace

std::vector<Row> r7_coverage(const Workshop& workshop) {
  const wii::FieldOfView fov;
  const std::uint64_t count = workshop.quick ? 200'000 : 4'000'000;
  const std::string file = workshop.file("r7_coverage.csv");
  std::string csv = "figure,from_m,to_m,as_printed,corrected,counted,standard_error,heads\n";
  std::vector<Row> rows;

  for (const double d : kDistances) {
    const double area = wii::trackable_area(fov, kSpacing, d);
    const wii::Counted counted = wii::count_trackable_area(fov, kSpacing, d, count, kSeed);
    csv += fmt::format("area,{},{},{},{},{},{},{}\n", d, d, area, area, counted.value, counted.standard_error, count);
    if (d != 1) continue;
    Row row{"R7", "trackable area at 1 m (eq. 2.1)", "m2", area, {}, {}, {}, {file}};
    enter(row, counted);
    row.why = fmt::format("counted over {} heads, {:+.1f} standard errors from eq. 2.1, which is exact", count,
                          off_by(counted, area));
    rows.push_back(row);
  }

  const double d1 = kDistances.front();
  const double d2 = kDistances.back();
  const double printed = wii::trackable_volume_as_printed(fov, kSpacing, d1, d2);
  const double corrected = wii::trackable_volume(fov, kSpacing, d1, d2);
  const wii::Counted counted = wii::count_trackable_volume(fov, kSpacing, d1, d2, count, kSeed);
  csv += fmt::format("volume,{},{},{},{},{},{},{}\n", d1, d2, printed, corrected, counted.value, counted.standard_error,
                     count);
  Row row{"R7", "trackable volume, 0.4 to 2 m (eq. 2.2)", "m3", printed, {}, {}, {}, {file}};
  enter(row, counted);
  row.why = fmt::format(
      "eq. 2.2 is the volume of a true frustum, but A(d) holds a constant -dLED and so keeps only 2/3 of that term; "
      "corrected it gives {:.5g} m3, from which the count is {:+.1f} standard errors away (as printed: {:+.1f})",
      corrected, off_by(counted, corrected), off_by(counted, printed));
  rows.push_back(row);
  write_text(file, csv, workshop.force);
  return rows;
}

}  // namespace verisim::reproduce
