#include "engine/stability/map_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>
#include <utility>

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/base/svg.hpp"

namespace verisim::stability {
namespace {

constexpr double kLeft = 70, kTop = 58, kWidth = 260, kLine = 30, kApart = 30;  // px
constexpr const char* kTheory = "#000000";

const char* colour_of(Outcome outcome) {
  switch (outcome) {
    case Outcome::stable:
      return svg::colour(2);
    case Outcome::limit_cycle:
      return svg::colour(4);
    default:
      return svg::colour(1);
  }
}

/// Words for SVG, which takes neither '<' nor '&'.
std::string plain(std::string words) {
  for (const auto& [sign, word] : {std::pair{"<=", "is at most"}, {"<", "is below"}})
    for (std::size_t at = 0; (at = words.find(sign, at)) != std::string::npos;)
      words.replace(at, std::string_view(sign).size(), word);
  return words;
}

double value(const Row& row, const std::string& name) {
  const std::optional<double> figure = row.figure(name);
  VERISIM_ASSERT(figure.has_value());
  return *figure;
}

struct Axes {
  double low, high;           ///< decades
  std::vector<double> lines;  ///< values of y
  [[nodiscard]] double x(double value) const {
    const double decade = pinned::log(value) / pinned::log(10.0);
    return kWidth * std::clamp((decade - low) / (high - low), 0.0, 1.0);
  }
  [[nodiscard]] double y(double value) const {
    const auto at = std::find(lines.begin(), lines.end(), value) - lines.begin();
    return kTop + kLine * (static_cast<double>(lines.size()) - 0.5 - static_cast<double>(at));
  }
  [[nodiscard]] double bottom() const { return kTop + kLine * static_cast<double>(lines.size()); }
};

Axes axes_of(const MapDescription& map, const std::vector<Row>& cells) {
  std::set<double> x, y;
  for (const Row& cell : cells) {
    x.insert(value(cell, map.x));
    y.insert(value(cell, map.y));
  }
  VERISIM_ASSERT(!x.empty() && *x.begin() > 0);
  const auto decade = [](double v) { return pinned::log(v) / pinned::log(10.0); };
  return {std::floor(decade(*x.begin()) + 1e-9), std::ceil(decade(*x.rbegin()) - 1e-9), {y.begin(), y.end()}};
}

std::string panel_of(const MapDescription& map, const std::vector<Row>& cells, const Axes& axes, double panel,
                     double left) {
  std::string content = svg::text(left + kWidth / 2, kTop - 8, "middle", fmt::format("{} {:g}", map.panel, panel));
  for (double decade = axes.low; decade <= axes.high; ++decade) {
    const double at = left + kWidth * (decade - axes.low) / (axes.high - axes.low);
    content += svg::line(at, kTop, at, axes.bottom(), "#ddd", 1) +
               svg::text(at, axes.bottom() + 14, "middle", fmt::format("1e{:g}", decade));
  }
  std::vector<std::pair<double, double>> theory;
  for (const double y : axes.lines)
    for (const Row& cell : cells) {
      if (value(cell, map.y) != y || value(cell, map.panel) != panel) continue;
      content += svg::dot(left + axes.x(value(cell, map.x)), axes.y(y), colour_of(cell.outcome));
      const double bound = cell.figure("bound").value_or(0);
      if (bound > 0 && (theory.empty() || theory.back().second != axes.y(y)))
        theory.emplace_back(left + axes.x(bound), axes.y(y));
    }
  return theory.size() > 1 ? content + svg::polyline(theory, kTheory) : content;
}

}  // namespace

std::string picture_of(const MapDescription& map, const std::vector<Row>& cells) {
  const Axes axes = axes_of(map, cells);
  std::set<double> panels;
  for (const Row& cell : cells) panels.insert(value(cell, map.panel));
  std::string content = svg::text(kLeft, 16, "start", plain(map.title));
  double x = kLeft;
  for (const Outcome outcome : {Outcome::stable, Outcome::limit_cycle, Outcome::diverged}) {
    content += svg::dot(x + 4, 30, colour_of(outcome)) + svg::text(x + 12, 34, "start", std::string(name_of(outcome)));
    x += 80;
  }
  content += svg::line(x, 30, x + 18, 30, kTheory, 1.5) + svg::text(x + 23, 34, "start", plain(map.theory));
  for (const double y : axes.lines) content += svg::text(kLeft - 6, axes.y(y) + 4, "end", fmt::format("{:g}", y));
  content += svg::text(8, kTop - 8, "start", map.y);
  double left = kLeft;
  for (const double panel : panels) {
    content += panel_of(map, cells, axes, panel, left);
    left += kWidth + kApart;
  }
  content += svg::text(kLeft, axes.bottom() + 32, "start", map.x);
  return svg::picture(std::max(left, 560.0), axes.bottom() + 42, content);
}

}  // namespace verisim::stability
