#include "engine/compare/shift.hpp"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/compare/rank_tests.hpp"

namespace verisim::compare {
namespace {

constexpr std::size_t kExactIntervalProduct = 2500;  // 50 by 50
constexpr std::size_t kExactIntervalPairs = 100;

double middle_of_sorted(const std::vector<double>& sorted) {
  const std::size_t n = sorted.size();
  return n % 2 == 1 ? sorted[n / 2] : 0.5 * (sorted[n / 2 - 1] + sorted[n / 2]);
}

/// How many of the smallest and of the largest values lie outside: the largest k with P(X <= k - 1) <= tail.
std::size_t outside_of(const std::vector<double>& below, double tail) {
  std::size_t k = 0;
  while (k < below.size() && below[k] <= tail) ++k;
  return k;
}

std::size_t outside_by_normal(double mean, double variance, double tail) {
  const double k =
      mean - boost::math::quantile(boost::math::complement(boost::math::normal(), tail)) * std::sqrt(variance);
  return k < 1 ? 0 : static_cast<std::size_t>(k);
}

/// `values` are all elementary estimates; the interval goes from the k-th smallest to the k-th largest.
Shift shift_of(std::vector<double> values, std::size_t k) {
  std::sort(values.begin(), values.end());
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const bool is_bounded = k > 0 && 2 * k <= values.size() + 1;
  return {middle_of_sorted(values), is_bounded ? values[k - 1] : -kInfinity,
          is_bounded ? values[values.size() - k] : kInfinity};
}

}  // namespace

Shift shift_of_samples(std::span<const double> a, std::span<const double> b, double level) {
  VERISIM_ASSERT(!a.empty());
  VERISIM_ASSERT(!b.empty());
  VERISIM_ASSERT(level > 0);
  VERISIM_ASSERT(level < 1);
  const double tail = 0.5 * (1 - level);
  const auto m = static_cast<double>(a.size()), n = static_cast<double>(b.size());
  const std::size_t k = a.size() * b.size() <= kExactIntervalProduct
                            ? outside_of(u_probabilities(a.size(), b.size()), tail)
                            : outside_by_normal(0.5 * m * n, m * n * (m + n + 1) / 12, tail);
  std::vector<double> differences;
  differences.reserve(a.size() * b.size());
  for (const double of_a : a)
    for (const double of_b : b) differences.push_back(of_b - of_a);
  return shift_of(std::move(differences), k);
}

Shift shift_of_pairs(std::span<const double> differences, double level) {
  VERISIM_ASSERT(!differences.empty());
  VERISIM_ASSERT(level > 0);
  VERISIM_ASSERT(level < 1);
  const double tail = 0.5 * (1 - level);
  const auto n = static_cast<double>(differences.size());
  const std::size_t k = differences.size() <= kExactIntervalPairs
                            ? outside_of(w_probabilities(differences.size()), tail)
                            : outside_by_normal(0.25 * n * (n + 1), n * (n + 1) * (2 * n + 1) / 24, tail);
  std::vector<double> means;
  means.reserve(differences.size() * (differences.size() + 1) / 2);
  for (std::size_t i = 0; i < differences.size(); ++i)
    for (std::size_t j = i; j < differences.size(); ++j) means.push_back(0.5 * (differences[i] + differences[j]));
  return shift_of(std::move(means), k);
}

double median_of(std::span<const double> values) {
  VERISIM_ASSERT(!values.empty());
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  return middle_of_sorted(sorted);
}

}  // namespace verisim::compare
