#include "engine/compare/bounds.hpp"
#include "engine/base/json.hpp"

#include <bit>
#include <cmath>

#include "engine/base/error.hpp"
#include "engine/compare/embedded.hpp"

namespace verisim::compare {
namespace {

double number_of(const std::string& file, const std::string& name, const Json& j, const char* key) {
  if (!j.contains(key)) return 0;
  if (!j[key].is_number() || !(j[key].get<double>() >= 0))
    fail(ErrorKind::input, "{}: '{}' of '{}' is not a number of 0 or more", file, key, name);
  return j[key].get<double>();
}

const Json& entry_of(const std::string& file, const Json& j, const char* name) {
  if (!j.contains(name) || !j[name].is_object())
    fail(ErrorKind::input, "{}: has no '{}'; bench/baseline/bounds.json shows how it looks", file, name);
  return j[name];
}

void check_source(const std::string& file, const std::string& name, const Json& j) {
  if (!j.is_object() || !j.contains("source") || !j["source"].is_string() || j["source"].get<std::string>().empty())
    fail(ErrorKind::input, "{}: the bound of '{}' does not say its source", file, name);
}

double bound_of(const std::string& file, const Json& j, const char* name) {
  const Json& entry = entry_of(file, j, name);
  check_source(file, name, entry);
  return number_of(file, name, entry, "bound");
}

}  // namespace

Bounds read_bounds(const std::string& name, const std::string& text) {
  const Json j = parse_json_of(name, text, "bench/baseline/bounds.json shows how it looks");
  if (!j.is_object()) fail(ErrorKind::input, "{}: is not a JSON object", name);
  Bounds bounds;
  for (const auto& [figure, entry] : entry_of(name, j, "figures").items()) {
    check_source(name, figure, entry);
    if (entry.contains("better") && !entry["better"].is_string())
      fail(ErrorKind::input, "{}: 'better' of '{}' is no text; write \"less\", or leave it out", name, figure);
    bounds.figures[figure] = {number_of(name, figure, entry, "relative"), number_of(name, figure, entry, "absolute"),
                              entry.value("better", "") == "less", entry["source"].get<std::string>()};
  }
  if (bounds.figures.count("measure") == 0) fail(ErrorKind::input, "{}: has no bound for 'measure'", name);
  bounds.effect_interleaved = bound_of(name, j, "times_interleaved");
  bounds.effect_apart = bound_of(name, j, "times_apart");
  bounds.flips = bound_of(name, j, "outcome_flips");
  return bounds;
}

const Bounds& built_in_bounds() {
  static const Bounds bounds = read_bounds("bounds.json", kBoundsText);
  return bounds;
}

AccuracyFigure Bounds::judge(const std::string& name, double a, double b) const {
  const auto own = figures.find(name);
  const Bound& bound = own != figures.end() ? own->second : figures.at("measure");
  const double allowed = std::max(bound.absolute, bound.relative * std::abs(a));
  AccuracyFigure figure{.name = name, .a = a, .b = b, .bound = allowed, .change = Change::none, .note = ""};
  if (std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b)) return figure;
  if (std::abs(b - a) <= allowed)
    figure.note = "within the bound";
  else  // a value that is not finite, too
    figure.change = !bound.less_is_better || !std::isfinite(b - a) ? Change::changed
                    : b > a                                        ? Change::worse
                                                                   : Change::better;
  return figure;
}

}  // namespace verisim::compare
