#include "engine/base/statistics.hpp"

#include <cmath>
#include <numeric>
#include <vector>

#include "engine/base/error.hpp"

namespace verisim {
namespace {

/// 97.5 % point of Student's t with this many degrees of freedom: Abramowitz and Stegun 26.7.5. Within 0.3 % from four
/// on; the exact values below.
double student_975(std::size_t degrees) {
  constexpr double kExact[] = {12.7062, 4.30265, 3.18245};
  if (degrees <= 3) return kExact[degrees - 1];
  constexpr double z = 1.959964;
  const auto v = static_cast<double>(degrees);
  const double z3 = z * z * z, z5 = z3 * z * z, z7 = z5 * z * z;
  return z + (z3 + z) / (4 * v) + (5 * z5 + 16 * z3 + 3 * z) / (96 * v * v) +
         (3 * z7 + 19 * z5 + 17 * z3 - 15 * z) / (384 * v * v * v);
}

double sum_of(std::span<const double> samples) {
  return std::accumulate(samples.begin(), samples.end(), 0.0);
}

}  // namespace

Estimate mean_of(std::span<const double> samples) {
  VERISIM_ASSERT(samples.size() >= 2);
  const auto n = static_cast<double>(samples.size());
  const double mean = sum_of(samples) / n;
  double squares = 0;
  for (const double s : samples) squares += (s - mean) * (s - mean);
  const double half = student_975(samples.size() - 1) * std::sqrt(squares / (n - 1) / n);
  return {mean, {mean - half, mean + half}};
}

Estimate ratio_of(std::span<const double> a, std::span<const double> b) {
  VERISIM_ASSERT(a.size() == b.size());
  const double ratio = sum_of(a) / sum_of(b);
  const double mean_b = sum_of(b) / static_cast<double>(b.size());
  std::vector<double> linearized(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) linearized[i] = ratio + (a[i] - ratio * b[i]) / mean_b;
  return {ratio, mean_of(linearized).interval};
}

}  // namespace verisim
