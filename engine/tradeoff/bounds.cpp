#include "engine/tradeoff/bounds.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/base/text.hpp"

namespace verisim::tradeoff {
namespace {

struct Unit {
  const char* text;
  const char* unit;  ///< what it is
  double factor;
  bool takes_prefix;
};
constexpr std::array kUnits = {Unit{"Nm", "N m", 1, true},  Unit{"N m", "N m", 1, true},
                               Unit{"N", "N", 1, true},     Unit{"m", "m", 1, true},
                               Unit{"s", "s", 1, true},     Unit{"J", "J", 1, true},
                               Unit{"rad", "rad", 1, true}, Unit{"deg", "rad", pinned::kFullTurn / 360, false},
                               Unit{"%", "1", 0.01, false}, Unit{"", "1", 1, false}};
constexpr std::pair<char, double> kPrefixes[] = {{'p', 1e-12}, {'n', 1e-9}, {'u', 1e-6}, {'m', 1e-3},
                                                 {'k', 1e3},   {'M', 1e6},  {'G', 1e9}};

/// Of each unit the kind that it means by itself.
constexpr Kind kUsual[] = {Kind::force, Kind::torque, Kind::overlap, Kind::rotation, Kind::work, Kind::wrench};

std::string names_of_kinds() {
  std::string names;
  for (const ErrorKindInfo& kind : kKinds) names += std::string(names.empty() ? "" : ", ") + kind.name;
  return names;
}

bool keeps(const Row& row, const Bounds& bounds) {
  if (bounds.budget_us && !(row.time_us.most <= *bounds.budget_us)) return false;
  if (!bounds.error) return true;
  const std::optional<Spread>& error = row.errors[index_of(bounds.error->kind)];
  return error && error->most <= bounds.error->most;
}

/// Whether a is the better answer.
bool is_better(const Row& a, const Row& b, bool by_load, Kind by) {
  const std::optional<Spread>& of_a = a.errors[index_of(by)];
  const std::optional<Spread>& of_b = b.errors[index_of(by)];
  if (by_load && a.load() != b.load()) return a.load() < b.load();
  if (of_a && of_b && of_a->most != of_b->most) return of_a->most < of_b->most;
  if (of_a.has_value() != of_b.has_value()) return of_a.has_value();
  return a.load() < b.load();
}

}  // namespace

Quantity quantity_from(const std::string& what, const std::string& text) {
  Quantity quantity;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, quantity.value);
  if (error != std::errc() || !std::isfinite(quantity.value))
    fail(ErrorKind::usage, "{}: '{}' is no number with a unit; write it as 200us, 0.05N, 0.01mm", what,
         shown(text, 40));
  std::string unit(rest, end);
  unit.erase(0, unit.find_first_not_of(' ') == std::string::npos ? unit.size() : unit.find_first_not_of(' '));
  for (const Unit& known : kUnits)
    if (unit == known.text) return {quantity.value * known.factor, known.unit};
  for (const Unit& known : kUnits)
    for (const auto& [prefix, factor] : kPrefixes)
      if (known.takes_prefix && unit == prefix + std::string(known.text)) return {quantity.value * factor, known.unit};
  fail(ErrorKind::usage, "{}: no unit '{}'; s, N, N m, m, rad, deg, J and % are known, with SI prefixes", what,
       shown(unit, 20));
}

double budget_from(const std::string& what, const std::string& text) {
  const Quantity time = quantity_from(what, text);
  if (time.unit != "s") fail(ErrorKind::usage, "{}: {} is no time; write it as 200us", what, shown(text, 40));
  if (!(time.value > 0)) fail(ErrorKind::usage, "{}: {} is not above 0", what, shown(text, 40));
  return time.value * 1e6;
}

Kind kind_named(const std::string& what, const std::string& name) {
  for (std::size_t i = 0; i < kKinds.size(); ++i)
    if (name == kKinds[i].name) return static_cast<Kind>(i);
  fail(ErrorKind::usage, "{}: no error is called '{}'; there are {}", what, shown(name, 40), names_of_kinds());
}

ErrorBound error_bound_from(const std::string& what, const std::string& text, const std::string& by) {
  const Quantity error = quantity_from(what, text);
  if (!(error.value > 0)) fail(ErrorKind::usage, "{}: {} is not above 0", what, shown(text, 40));
  if (!by.empty()) {
    const Kind kind = kind_named("--by " + by, by);
    if (error.unit != kKinds[index_of(kind)].unit)
      fail(ErrorKind::usage, "{}: {} is of unit '{}', and {} is of unit '{}'", what, shown(text, 40), error.unit, by,
           kKinds[index_of(kind)].unit);
    return {kind, error.value};
  }
  for (const Kind kind : kUsual)
    if (error.unit == kKinds[index_of(kind)].unit) return {kind, error.value};
  fail(ErrorKind::usage, "{}: no error is of unit '{}'; a budget of time is --budget", what, error.unit);
}

std::optional<std::size_t> choose(const std::vector<Row>& rows, const Bounds& bounds, Kind by, Prefer prefer) {
  const bool by_load = bounds.error.has_value() && prefer == Prefer::cheapest;
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!rows[i].failed.empty() || !keeps(rows[i], bounds)) continue;
    if (!best || is_better(rows[i], rows[*best], by_load, bounds.error ? bounds.error->kind : by)) best = i;
  }
  return best;
}

std::string coverage_text(std::uint64_t repetitions) {
  const double coverage = coverage_of(repetitions);
  return fmt::format("bounds that {} kept are expected to hold in {:.3g} % of further trials{}",
                     repetitions == 1 ? "the one repetition" : fmt::format("all {} repetitions", repetitions),
                     100 * coverage, coverage < kWantedCoverage ? "; --repeat 19 makes it 95 %" : "");
}

std::string text_of(const Bounds& bounds) {
  std::string text;
  if (bounds.budget_us) text += fmt::format("a median frame with contact of at most {:g} us", *bounds.budget_us);
  if (bounds.error) {
    const ErrorKindInfo& kind = kKinds[index_of(bounds.error->kind)];
    const std::string unit = kind.unit == std::string("1") ? "" : std::string(" ") + kind.unit;
    text += fmt::format("{}an error '{}' of at most {:g}{}", text.empty() ? "" : " and ", kind.name, bounds.error->most,
                        unit);
  }
  return text;
}

}  // namespace verisim::tradeoff
