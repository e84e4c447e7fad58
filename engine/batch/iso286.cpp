#include "engine/batch/iso286.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>

#include "engine/base/error.hpp"

namespace verisim::batch {
namespace {

constexpr std::size_t kRows = 10;
using Row = std::array<int, kRows>;  // um; a figure for each row of nominal sizes

constexpr Row kUpTo = {3, 6, 10, 18, 30, 50, 65, 80, 100, 120};  // mm: a row ends with this nominal size

struct Grade {
  int number;
  Row tolerance;
};
constexpr std::array kGrades = {
    Grade{5, {4, 5, 6, 8, 9, 11, 13, 13, 15, 15}},
    Grade{6, {6, 8, 9, 11, 13, 16, 19, 19, 22, 22}},
    Grade{7, {10, 12, 15, 18, 21, 25, 30, 30, 35, 35}},
    Grade{8, {14, 18, 22, 27, 33, 39, 46, 46, 54, 54}},
    Grade{9, {25, 30, 36, 43, 52, 62, 74, 74, 87, 87}},
    Grade{10, {40, 48, 58, 70, 84, 100, 120, 120, 140, 140}},
    Grade{11, {60, 75, 90, 110, 130, 160, 190, 190, 220, 220}},
};

struct Letter {
  char letter;
  Row deviation;
};
constexpr std::array kBelow = {
    // shafts thinner than nominal: upper deviation
    Letter{'d', {-20, -30, -40, -50, -65, -80, -100, -100, -120, -120}},
    Letter{'e', {-14, -20, -25, -32, -40, -50, -60, -60, -72, -72}},
    Letter{'f', {-6, -10, -13, -16, -20, -25, -30, -30, -36, -36}},
    Letter{'g', {-2, -4, -5, -6, -7, -9, -10, -10, -12, -12}},
    Letter{'h', {0, 0, 0, 0, 0, 0, 0, 0, 0, 0}},
};
constexpr std::array kAbove = {
    // shafts thicker than nominal: lower deviation (k: to grade 7; 0 beyond)
    Letter{'k', {0, 1, 1, 1, 2, 2, 2, 2, 3, 3}},           Letter{'m', {2, 4, 6, 7, 8, 9, 11, 11, 13, 13}},
    Letter{'n', {4, 8, 10, 12, 15, 17, 20, 20, 23, 23}},   Letter{'p', {6, 12, 15, 18, 22, 26, 32, 32, 37, 37}},
    Letter{'r', {10, 15, 19, 23, 28, 34, 41, 43, 51, 54}}, Letter{'s', {14, 19, 23, 28, 35, 43, 53, 59, 71, 79}},
};

template <std::size_t N>
std::optional<double> deviation_of(const std::array<Letter, N>& letters, char letter, std::size_t row) {
  const auto found = std::find_if(letters.begin(), letters.end(), [&](const Letter& l) { return l.letter == letter; });
  if (found == letters.end()) return {};
  return found->deviation[row];
}

std::size_t row_of(const std::string& what, double nominal) {
  const double mm = nominal * 1000;
  if (mm > 3 - 1e-9)
    for (std::size_t row = 0; row < kRows; ++row)
      if (mm <= kUpTo[row] + 1e-9) return row;
  fail(ErrorKind::usage, "{}: the diameter is {} mm; the table has 3 to 120 mm", what, mm);
}

/// In um; nothing if the table does not have the zone.
std::optional<Deviations> in_micrometres(const std::string& letters, int number, std::size_t row) {
  const auto grade = std::find_if(kGrades.begin(), kGrades.end(), [&](const Grade& g) { return g.number == number; });
  if (grade == kGrades.end()) return {};
  const double it = grade->tolerance[row];
  if (letters == "js" || letters == "JS") return Deviations{-it / 2, it / 2};
  if (letters.size() != 1) return {};
  const char letter = letters[0];
  if (const auto upper = deviation_of(kBelow, letter, row)) return Deviations{*upper - it, *upper};
  if (const auto lower = deviation_of(kAbove, letter, row)) {
    const double low = letter == 'k' && number > 7 ? 0 : *lower;
    return Deviations{low, low + it};
  }
  // By 4.3.2.5 the holes D to H mirror the shafts d to h, EI = -es.
  if (std::isupper(static_cast<unsigned char>(letter)) == 0) return {};
  const char shaft = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  if (const auto mirrored = deviation_of(kBelow, shaft, row)) return Deviations{-*mirrored, it - *mirrored};
  return {};
}

}  // namespace

Deviations deviations(const std::string& what, const std::string& zone, double nominal) {
  const std::size_t row = row_of(what, nominal);
  const std::size_t digits = zone.find_first_of("0123456789");
  const bool has_form = digits != std::string::npos && digits > 0 && digits + 2 >= zone.size() &&
                        zone.find_first_not_of("0123456789", digits) == std::string::npos;
  const auto found = has_form ? in_micrometres(zone.substr(0, digits), std::stoi(zone.substr(digits)), row)
                              : std::optional<Deviations>();
  if (!found)
    fail(ErrorKind::usage,
         "{}: there is no zone '{}'; the table has holes D E F G H JS and shafts d e f g h js k m n p r s, grades 5 to "
         "11, as in H7",
         what, zone);
  return {found->lower * 1e-6, found->upper * 1e-6};
}

}  // namespace verisim::batch
