#include "engine/reproduce/chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/base/svg.hpp"

namespace verisim::reproduce {
namespace {

constexpr double kLeft = 60, kTop = 32, kWidth = 480, kHeight = 240;  // px

/// The step of an axis from 0 to `most` with some five ticks: 1, 2 or 5 times a power of ten.
double tick_of(double most) {
  double step = 1;
  while (step * 5 > most) step /= 10;
  while (step * 50 <= most) step *= 10;
  for (const double times : {1.0, 2.0, 5.0})
    if (6 * times * step > most) return times * step;
  return 10 * step;
}

}  // namespace

std::string line_chart(const std::string& x_label, const std::string& y_label, const std::vector<Curve>& curves) {
  double x_max = 0, y_max = 0;
  std::vector<std::string> names;
  for (const Curve& curve : curves) {
    VERISIM_ASSERT(curve.points.size() > 1);
    names.push_back(curve.name);
    for (const auto& [x, y] : curve.points) {
      x_max = std::max(x_max, x);
      y_max = std::max(y_max, y);
    }
  }
  VERISIM_ASSERT(std::min(x_max, y_max) > 0);
  const double x_tick = tick_of(x_max), y_tick = tick_of(y_max);
  x_max = std::ceil(x_max / x_tick - 1e-9) * x_tick;
  y_max = std::ceil(y_max / y_tick - 1e-9) * y_tick;
  const auto x_of = [&](double x) { return kLeft + kWidth * x / x_max; };
  const auto y_of = [&](double y) { return kTop + kHeight * (1 - y / y_max); };
  std::string content = svg::legend(names, kLeft, 16);
  for (int i = 0; i * x_tick < x_max + x_tick / 2; ++i)
    content += svg::line(x_of(i * x_tick), kTop, x_of(i * x_tick), kTop + kHeight, "#eee", 1) +
               svg::text(x_of(i * x_tick), kTop + kHeight + 14, "middle", fmt::format("{:.3g}", i * x_tick));
  for (int i = 0; i * y_tick < y_max + y_tick / 2; ++i)
    content += svg::line(kLeft, y_of(i * y_tick), kLeft + kWidth, y_of(i * y_tick), "#ddd", 1) +
               svg::text(kLeft - 6, y_of(i * y_tick) + 4, "end", fmt::format("{:.3g}", i * y_tick));
  for (std::size_t c = 0; c < curves.size(); ++c) {
    std::vector<std::pair<double, double>> points;
    for (const auto& [x, y] : curves[c].points) points.emplace_back(x_of(x), y_of(y));
    content += svg::polyline(points, svg::colour(c));
  }
  content += svg::text(kLeft + kWidth / 2, kTop + kHeight + 32, "middle", x_label + "; " + y_label);
  return svg::picture(kLeft + kWidth + 20, kTop + kHeight + 42, content);
}

std::string interval_chart(const std::string& x_label, const std::vector<std::string>& series,
                           const std::vector<IntervalRow>& rows) {
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (const IntervalRow& row : rows) {
    VERISIM_ASSERT(row.estimates.size() == series.size());
    for (const Estimate& e : row.estimates) {
      if (!(e.value > 0)) continue;
      least = std::min(least, e.interval.first > 0 ? e.interval.first : e.value / 2);
      most = std::max(most, e.interval.second);
    }
  }
  const double low = std::floor(pinned::log(std::min(least, most)) / pinned::log(10.0));
  const double high = std::max(low + 1, std::ceil(pinned::log(std::max(most, 1e-12)) / pinned::log(10.0)));
  constexpr double kNames = 300;  // px
  const double lane = 8, band = lane * static_cast<double>(series.size() + 1);
  const double bottom = kTop + band * static_cast<double>(rows.size());
  const auto x_of = [&](double value) {
    return kNames + kWidth * std::clamp((pinned::log(value) / pinned::log(10.0) - low) / (high - low), 0.0, 1.0);
  };
  std::string content = svg::legend(series, kNames, 16);
  for (double power = low; power <= high; ++power) {
    const double x = kNames + kWidth * (power - low) / (high - low);
    content += svg::line(x, kTop, x, bottom, "#ddd", 1) +
               svg::text(x, bottom + 14, "middle", fmt::format("{:g}", pinned::pow(10.0, power)));
  }
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const double y = kTop + band * static_cast<double>(r);
    content += svg::line(kNames, y, kNames + kWidth, y, "#eee", 1) +
               svg::text(kNames - 6, y + band / 2 + 4, "end", rows[r].name);
    for (std::size_t s = 0; s < series.size(); ++s) {
      const Estimate& e = rows[r].estimates[s];
      if (!(e.value > 0)) continue;
      const double at = y + lane * static_cast<double>(s + 1);
      const double from = e.interval.first > 0 ? x_of(e.interval.first) : kNames;
      content += svg::line(from, at, x_of(e.interval.second), at, svg::colour(s), 1) +
                 svg::dot(x_of(e.value), at, svg::colour(s));
    }
  }
  content += svg::text(kNames + kWidth / 2, bottom + 32, "middle", x_label + "; dot: mean, line: 95 % interval");
  return svg::picture(kNames + kWidth + 20, bottom + 42, content);
}

}  // namespace verisim::reproduce
