#include "engine/batch/intervals.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"

namespace verisim::batch {

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

Interval bootstrap_of_mean(const std::vector<double>& values, std::uint64_t seed, const std::string& name) {
  VERISIM_ASSERT(!values.empty());
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  if (*least == *most) return {*least, *most};
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
  constexpr double kOutside = 0.025;
  const auto outside = static_cast<std::size_t>(kOutside * static_cast<double>(resamples));
  return {means[outside], means[resamples - 1 - outside]};
}

}  // namespace verisim::batch
