#include "engine/wii/validation_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/svg.hpp"

namespace verisim::wii {
namespace {

using svg::colour;
using svg::dot;
using svg::legend;
using svg::line;
using svg::picture;
using svg::text;

constexpr double kErrorMin = 1e-4;  ///< m: left or lower end of every error axis
constexpr double kErrorMax = 2;     ///< m
constexpr std::array kTicks = {1e-4, 1e-3, 1e-2, 1e-1, 1.0};
constexpr int kSteps = 400;  ///< of a history

/// Share of the way along an error axis, 0 to 1.
double along(double error) {
  const double clamped = std::clamp(error, kErrorMin, kErrorMax);
  return pinned::log(clamped / kErrorMin) / pinned::log(kErrorMax / kErrorMin);
}

/// Different values of one member, in order of first appearance.
std::vector<std::string> names_in(const std::vector<ValidationRow>& rows, std::string ValidationRow::*member) {
  std::vector<std::string> names;
  for (const ValidationRow& row : rows)
    if (std::find(names.begin(), names.end(), row.*member) == names.end()) names.push_back(row.*member);
  return names;
}

std::string cm(double metres) {
  return fmt::format("{:g}", 100 * metres);
}

/// The worst of a history in each of kSteps steps of time; empty steps had nothing valid.
struct Step {
  bool valid = false;
  double error = 0;
  double bound = 0;
};
std::vector<Step> steps_of(const ErrorHistory& history, double duration) {
  std::vector<Step> steps(kSteps);
  for (const ErrorSample& s : history.samples) {
    if (!s.valid) continue;
    Step& step = steps[static_cast<std::size_t>(std::clamp(s.t / duration * kSteps, 0.0, kSteps - 1.0))];
    step.valid = true;
    step.error = std::max(step.error, s.error);
    step.bound = std::max(step.bound, s.bound_95);
  }
  return steps;
}

}  // namespace

std::string overview_plot(const std::vector<ValidationRow>& rows) {
  const std::vector<std::string> sensors = names_in(rows, &ValidationRow::sensor);
  const std::vector<std::string> paths = names_in(rows, &ValidationRow::trajectory);
  const std::vector<std::string> trackers = names_in(rows, &ValidationRow::tracker);
  const auto place_in = [](const std::vector<std::string>& names, const std::string& name) {
    return static_cast<double>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  constexpr double kLeft = 95;
  constexpr double kTop = 52;
  constexpr double kPanel = 330;
  constexpr double kGap = 14;
  const double lane = 5;
  const double band = lane * static_cast<double>(trackers.size() + 1);
  const double bottom = kTop + band * static_cast<double>(paths.size());
  const double right = kLeft + (kPanel + kGap) * static_cast<double>(sensors.size());
  std::string svg = legend(trackers, kLeft, 16);
  for (std::size_t p = 0; p < paths.size(); ++p)
    svg += text(kLeft - 6, kTop + band * (static_cast<double>(p) + 0.5) + 4, "end", paths[p]);
  for (std::size_t s = 0; s < sensors.size(); ++s) {
    const double x0 = kLeft + (kPanel + kGap) * static_cast<double>(s);
    svg += text(x0 + kPanel / 2, kTop - 8, "middle", sensors[s]);
    for (const double tick : kTicks) {
      const double x = x0 + kPanel * along(tick);
      svg += line(x, kTop, x, bottom, "#ddd", 1) + text(x, bottom + 14, "middle", cm(tick));
    }
    for (std::size_t p = 0; p <= paths.size(); ++p) {
      const double y = kTop + band * static_cast<double>(p);
      svg += line(x0, y, x0 + kPanel, y, "#eee", 1);
    }
  }
  for (const ValidationRow& row : rows) {
    if (row.valid == 0) continue;
    const double which = place_in(trackers, row.tracker);
    const double x0 = kLeft + (kPanel + kGap) * place_in(sensors, row.sensor);
    const double y = kTop + band * place_in(paths, row.trajectory) + lane * (which + 1);
    const char* stroke = colour(static_cast<std::size_t>(which));
    const double x = x0 + kPanel * along(row.position.rms);
    svg += line(x, y, x0 + kPanel * along(row.position.max), y, stroke, 1);
    svg += dot(x, y, stroke);
  }
  svg += text((kLeft + right - kGap) / 2, bottom + 32, "middle", "position error [cm]: dot rms, line to the maximum");
  return picture(right, bottom + 42, svg);
}

std::string history_plot(const std::string& title, const std::vector<ErrorHistory>& histories) {
  constexpr double kLeft = 60;
  constexpr double kTop = 44;
  constexpr double kWidth_ = 800;
  constexpr double kPlotHeight_ = 280;
  double duration = 1e-9;
  std::vector<std::string> trackers;
  for (const ErrorHistory& h : histories) {
    trackers.push_back(h.tracker);
    if (!h.samples.empty()) duration = std::max(duration, h.samples.back().t);
  }
  std::string svg = legend(trackers, kLeft, 16) + text(kLeft + kWidth_ / 2, kTop - 8, "middle", title);
  const auto y_of = [&](double error) { return kTop + kPlotHeight_ * (1 - along(error)); };
  for (const double tick : kTicks)
    svg += line(kLeft, y_of(tick), kLeft + kWidth_, y_of(tick), "#ddd", 1) +
           text(kLeft - 6, y_of(tick) + 4, "end", cm(tick));
  constexpr int kTimeTicks = 5;
  for (int i = 0; i <= kTimeTicks; ++i) {
    const double x = kLeft + kWidth_ * i / kTimeTicks;
    svg += line(x, kTop, x, kTop + kPlotHeight_, "#eee", 1) +
           text(x, kTop + kPlotHeight_ + 15, "middle", fmt::format("{:.3g}", duration * i / kTimeTicks));
  }
  for (std::size_t h = 0; h < histories.size(); ++h) {
    const std::vector<Step> steps = steps_of(histories[h], duration);
    const auto path = [&](double Step::*value, double opacity) {
      std::string d;
      for (int i = 0; i < kSteps; ++i) {
        const Step& step = steps[static_cast<std::size_t>(i)];
        if (!step.valid) continue;
        const bool begins = i == 0 || !steps[static_cast<std::size_t>(i - 1)].valid;
        d += fmt::format("{}{:.0f} {:.1f}", begins ? 'M' : 'L', kLeft + kWidth_ * i / kSteps, y_of(step.*value));
      }
      return fmt::format("<path d=\"{}\" stroke=\"{}\" stroke-opacity=\"{}\"/>\n", d, colour(h), opacity);
    };
    svg += path(&Step::bound, 0.35) + path(&Step::error, 1);
  }
  svg += text(kLeft + kWidth_ / 2, kTop + kPlotHeight_ + 32, "middle",
              "time [s]; position error [cm], pale: the tracker's own 95 % bound");
  return picture(kLeft + kWidth_ + 20, kTop + kPlotHeight_ + 42, svg);
}

}  // namespace verisim::wii
