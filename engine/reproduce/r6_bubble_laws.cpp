// R6: figure 4.6, the rate of a bubble by how far the handle is outside of it: the quadratic law with K' = 7 and the
// peak ring with R = 0.45 m, x* = 0.15, beta = 0.3, v* = 1.5 m/s.
//
// `published` are the parameters that the figure was drawn from. `here` is measured: the handle of a bubble around a
// hand that holds still, between two frames.
#include <algorithm>
#include <array>

#include "engine/base/error.hpp"
#include "engine/device/bubble.hpp"
#include "engine/device/sources.hpp"
#include "engine/record/output_place.hpp"
#include "engine/reproduce/chart.hpp"
#include "engine/reproduce/reproductions.hpp"

namespace verisim::reproduce {
namespace {

constexpr double kRadius = 0.45;  ///< m
constexpr double kPeak = 0.0675;  ///< m, R x*
constexpr double kEnd = 0.3;      ///< m, as far as the figure's axis
constexpr double kStep = 1e-3;    ///< s

/// With which a bubble moves the handle of a hand that is x outside of it [m/s].
double measured_rate(BubbleLawKind kind, double scale, double x) {
  BubbleDescription bubble;
  bubble.radius = kRadius;
  bubble.law = {kind, scale, 0.15, 0.3};
  HapticSamples still{{0}, {{{kRadius + x, 0, 0}, Quaterniond::Identity()}}, {}};
  const auto device = make_bubble(make_replay("hand", std::move(still)), bubble);
  double before = 0;
  for (std::uint64_t frame = 0; frame < 2; ++frame) {
    before = device->reading().handle.position.x();
    device->sample({frame, static_cast<double>(frame) * kStep, kStep, 0, false});
  }
  return (device->reading().handle.position.x() - before) / kStep;
}

}  // namespace

std::vector<Row> r6_bubble_laws(const Workshop& workshop) {
  const std::string file = workshop.file("r6_bubble_laws.csv");
  const std::string figure = workshop.file("r6_figure_4_6.svg");
  std::string csv = "outside_m,quadratic,peak_ring,peak_ring_as_printed\n";
  std::vector<Curve> curves = {{"quadratic", {}}, {"peak ring", {}}, {"peak ring as printed", {}}};
  double peak = 0, peak_at = 0, peak_as_printed = 0;
  const int count = workshop.quick ? 400 : 4000;
  for (int i = 0; i <= count; ++i) {
    const double x = kEnd * i / count;
    const double quadratic = measured_rate(BubbleLawKind::quadratic, 7, x);
    const double ring = measured_rate(BubbleLawKind::peak_ring, 1.5, x);
    const double as_printed = measured_rate(BubbleLawKind::peak_ring_as_printed, 1.5, x);
    csv += fmt::format("{},{},{},{}\n", x, quadratic, ring, as_printed);
    const std::array rates = {quadratic, ring, as_printed};
    for (std::size_t c = 0; c < rates.size(); ++c) curves[c].points.emplace_back(x, rates[c]);
    if (ring > peak) peak_at = x;
    peak = std::max(peak, ring);
    if (x < kPeak) peak_as_printed = std::max(peak_as_printed, as_printed);
  }
  write_text(file, csv, workshop.force);
  write_text(figure, line_chart("distance outside of the bubble [m]", "rate of the bubble [m/s]", curves),
             workshop.force);
  const auto row = [&](const char* what, const char* unit, double published, double here, std::string why) {
    return Row{"R6", what, unit, published, here, {}, std::move(why), {file, figure}};
  };
  return {row("peak rate of the peak ring", "m/s", 1.5, peak,
              fmt::format("eq. 4.4 as printed divides by x*^2 where it needs (R x*)^2, and peaks at {:.3g} m/s",
                          peak_as_printed)),
          row("where the peak ring peaks", "m", kPeak, peak_at,
              "measured in steps along the axis; the curve is flat there"),
          row("rate of the peak ring far outside", "m/s", 0.45, measured_rate(BubbleLawKind::peak_ring, 1.5, kEnd),
              "beta v*; equal to rounding"),
          row("rate of the quadratic law, 0.3 m outside", "m/s", 7 * kEnd * kEnd,
              measured_rate(BubbleLawKind::quadratic, 7, kEnd), "equal to rounding")};
}

}  // namespace verisim::reproduce
