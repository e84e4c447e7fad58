#include "engine/batch/intervals.hpp"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"

namespace verisim::batch {
namespace {

constexpr double kOutside = 0.025;  // of an interval of 95 %, at each end

double students_t(std::size_t values) {
  const boost::math::students_t distribution(static_cast<double>(values - 1));
  return boost::math::quantile(boost::math::complement(distribution, kOutside));
}

/// Of n values a resample scatters by a factor of sqrt((n - 1) / n) less than the mean does, and as the normal
/// distribution does, not as Student's: as much farther out lie the quantiles that hold 95 %.
double widened(std::size_t values) {
  const auto n = static_cast<double>(values);
  return boost::math::cdf(boost::math::normal(), -std::sqrt(n / (n - 1)) * students_t(values));
}

Interval student_of_mean(const std::vector<double>& values) {
  const double mean = mean_of(values);
  double squares = 0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  const auto n = static_cast<double>(values.size());
  const double half = students_t(values.size()) * std::sqrt(squares / (n - 1) / n);
  return {mean - half, mean + half};
}

}  // namespace

Interval wilson(std::uint64_t count, std::uint64_t all) {
  VERISIM_ASSERT(all > 0);
  VERISIM_ASSERT(count <= all);
  constexpr double z = 1.959963984540054;  // the 97.5 % quantile of the normal distribution
  const auto n = static_cast<double>(all);
  const double p = static_cast<double>(count) / n;
  const double middle = p + z * z / (2 * n);
  const double half = z * std::sqrt(p * (1 - p) / n + z * z / (4 * n * n));
  const double scale = 1 + z * z / n;
  // At the ends the bound is the share itself; rounding is not to say otherwise.
  return {count == 0 ? 0 : (middle - half) / scale, count == all ? 1 : (middle + half) / scale};
}

double mean_of(const std::vector<double>& values) {
  VERISIM_ASSERT(!values.empty());
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

std::optional<Interval> interval_of_mean(const std::vector<double>& values, std::uint64_t seed,
                                         const std::string& name) {
  VERISIM_ASSERT(!values.empty());
  if (values.size() == 1) return std::nullopt;
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  if (*least == *most) return Interval{*least, *most};
  if (values.size() < kBootstrapLeast) return student_of_mean(values);
  constexpr std::uint64_t kResamplesMost = 2000, kResamplesLeast = 200, kDraws = 20'000'000;
  const RandomStream stream(seed, "batch bootstrap " + name);
  const std::uint64_t n = values.size();
  const std::uint64_t resamples = std::clamp(kDraws / n, kResamplesLeast, kResamplesMost);
  std::vector<double> means(resamples);
  for (std::uint64_t r = 0; r < resamples; ++r) {
    double sum = 0;
    for (std::uint64_t i = 0; i < n; ++i) {
      const double u = stream.uniform(r * n + i);
      sum += values[std::min(n - 1, static_cast<std::uint64_t>(u * static_cast<double>(n)))];
    }
    means[r] = sum / static_cast<double>(n);
  }
  std::sort(means.begin(), means.end());
  const auto outside = static_cast<std::size_t>(widened(n) * static_cast<double>(resamples));
  return Interval{means[outside], means[resamples - 1 - outside]};
}

}  // namespace verisim::batch
