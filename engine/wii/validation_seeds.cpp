#include <algorithm>
#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/statistics.hpp"
#include "engine/wii/validate.hpp"

namespace verisim::wii {
namespace {

/// The mean of a figure, and its interval.
template <typename Figure>
verisim::Estimate mean_over(const std::vector<ValidationRow>& rows, Figure figure) {
  std::vector<double> samples;
  for (const ValidationRow& r : rows) samples.push_back(static_cast<double>(figure(r)));
  return verisim::mean_of(samples);
}

ErrorFigures mean_figures(const std::vector<ValidationRow>& rows, ErrorFigures ValidationRow::*of) {
  ErrorFigures f;
  f.rms = mean_over(rows, [&](const ValidationRow& r) { return (r.*of).rms; }).value;
  f.p95 = mean_over(rows, [&](const ValidationRow& r) { return (r.*of).p95; }).value;
  for (const ValidationRow& r : rows) f.max = std::max(f.max, (r.*of).max);
  for (int i = 0; i < 3; ++i)
    f.rms_axis[i] = mean_over(rows, [&](const ValidationRow& r) { return (r.*of).rms_axis[i]; }).value;
  return f;
}

}  // namespace

ValidationRow mean_of_seeds(const std::vector<ValidationRow>& rows) {
  VERISIM_ASSERT(rows.size() >= 2);
  ValidationRow mean = rows.front();
  mean.seeds = static_cast<int>(rows.size());
  mean.position = mean_figures(rows, &ValidationRow::position);
  mean.orientation = mean_figures(rows, &ValidationRow::orientation);
  mean.position_rms_95 = mean_over(rows, [](const ValidationRow& r) { return r.position.rms; }).interval;
  mean.orientation_rms_95 = mean_over(rows, [](const ValidationRow& r) { return r.orientation.rms; }).interval;
  for (double ValidationRow::*figure :
       {&ValidationRow::availability, &ValidationRow::false_validity, &ValidationRow::latency, &ValidationRow::nees,
        &ValidationRow::nees_lower, &ValidationRow::nees_upper, &ValidationRow::within_95,
        &ValidationRow::orientation_nees, &ValidationRow::orientation_nees_lower,
        &ValidationRow::orientation_nees_upper})
    mean.*figure = mean_over(rows, [&](const ValidationRow& r) { return r.*figure; }).value;
  for (int ValidationRow::*count : {&ValidationRow::reports, &ValidationRow::valid, &ValidationRow::reacquired})
    mean.*count =
        static_cast<int>(std::lround(mean_over(rows, [&](const ValidationRow& r) { return r.*count; }).value));
  for (const ValidationRow& r : rows) {
    mean.longest_return = std::max(mean.longest_return, r.longest_return);
    mean.consistent = mean.consistent && r.consistent;
  }
  return mean;
}

}  // namespace verisim::wii
