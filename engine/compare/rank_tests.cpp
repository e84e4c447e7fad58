#include "engine/compare/rank_tests.hpp"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <numeric>

#include "engine/base/error.hpp"

namespace verisim::compare {
namespace {

constexpr std::size_t kExactSample = 8;        // SciPy's rule
constexpr std::size_t kExactProduct = 10'000;  // beyond, SciPy's exact p takes long and differs by less than 1e-3
constexpr std::size_t kExactPairs = 100;       // beyond, the normal approximation is as good, and much faster

double upper_tail(double z) {
  return boost::math::cdf(boost::math::complement(boost::math::normal(), z));
}

/// Ranks from 1; equal values share the mean of theirs. `ties` is the sum of t^3 - t over groups of t equal values.
std::vector<double> ranks_of(const std::vector<double>& values, double& ties) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t k) { return values[i] < values[k]; });
  std::vector<double> ranks(values.size());
  ties = 0;
  for (std::size_t from = 0, to = 0; from < order.size(); from = to) {
    while (to < order.size() && values[order[to]] == values[order[from]]) ++to;
    const auto t = static_cast<double>(to - from);
    ties += t * t * t - t;
    for (std::size_t i = from; i < to; ++i) ranks[order[i]] = 0.5 * static_cast<double>(from + 1 + to);
  }
  return ranks;
}

bool has_nan(std::span<const double> values) {
  return std::any_of(values.begin(), values.end(), [](double value) { return std::isnan(value); });
}

/// P(X <= x) from how often each x comes.
std::vector<double> cumulated(std::vector<double> counts) {
  const double all = std::accumulate(counts.begin(), counts.end(), 0.0);
  double sum = 0;
  for (double& count : counts) {
    sum += count;
    count = sum / all;
  }
  return counts;
}

/// In how many of the 2^n choices of signs do the positive ranks sum to each value? In units of 2^-n.
std::vector<double> signed_sums(const std::vector<std::size_t>& ranks) {
  std::vector<double> counts(std::accumulate(ranks.begin(), ranks.end(), std::size_t{0}) + 1, 0.0);
  counts[0] = 1;
  std::size_t reached = 0;
  for (const std::size_t rank : ranks) {
    reached += rank;
    for (std::size_t sum = reached + 1; sum-- > 0;)
      counts[sum] = 0.5 * (counts[sum] + (sum >= rank ? counts[sum - rank] : 0.0));
  }
  return counts;
}

double exact_signed_p(const std::vector<double>& ranks, double positive) {
  std::vector<std::size_t> doubled;  // shared ranks are halves
  for (const double rank : ranks) doubled.push_back(static_cast<std::size_t>(2 * rank));
  const std::vector<double> below = cumulated(signed_sums(doubled));
  const auto least = static_cast<std::size_t>(2 * positive);
  const std::size_t smaller = std::min(least, below.size() - 1 - least);
  return std::min(1.0, 2 * below[smaller]);
}

}  // namespace

RankTest mann_whitney(std::span<const double> a, std::span<const double> b) {
  VERISIM_ASSERT(!a.empty());
  VERISIM_ASSERT(!b.empty());
  VERISIM_ASSERT(!has_nan(a));
  VERISIM_ASSERT(!has_nan(b));
  std::vector<double> both(a.begin(), a.end());
  both.insert(both.end(), b.begin(), b.end());
  double ties = 0;
  const std::vector<double> ranks = ranks_of(both, ties);
  const auto m = static_cast<double>(a.size()), n = static_cast<double>(b.size());
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += ranks[i];
  const double u = sum - 0.5 * m * (m + 1);
  const double larger = std::max(u, m * n - u);
  if (std::min(a.size(), b.size()) <= kExactSample && a.size() * b.size() <= kExactProduct && ties == 0) {
    const std::vector<double> below = u_probabilities(a.size(), b.size());
    return {u, std::min(1.0, 2 * below[static_cast<std::size_t>(m * n - larger)])};
  }
  const double variance = m * n / 12 * (m + n + 1 - ties / ((m + n) * (m + n - 1)));
  if (variance <= 0) return {u, 1};  // all are equal
  return {u, std::min(1.0, 2 * upper_tail((larger - 0.5 * m * n - 0.5) / std::sqrt(variance)))};
}

RankTest signed_rank(std::span<const double> differences) {
  VERISIM_ASSERT(!has_nan(differences));
  std::vector<double> sizes;
  std::vector<bool> is_positive;
  for (const double d : differences) {
    if (d == 0) continue;
    sizes.push_back(std::abs(d));
    is_positive.push_back(d > 0);
  }
  if (sizes.empty()) return {0, 1};
  double ties = 0;
  const std::vector<double> ranks = ranks_of(sizes, ties);
  double positive = 0;
  for (std::size_t i = 0; i < ranks.size(); ++i)
    if (is_positive[i]) positive += ranks[i];
  if (ranks.size() <= kExactPairs) return {positive, exact_signed_p(ranks, positive)};
  const auto n = static_cast<double>(ranks.size());
  const double variance = n * (n + 1) * (2 * n + 1) / 24 - ties / 48;
  const double z = std::max(0.0, std::abs(positive - 0.25 * n * (n + 1)) - 0.5) / std::sqrt(variance);
  return {positive, std::min(1.0, 2 * upper_tail(z))};
}

std::vector<double> u_probabilities(std::size_t m, std::size_t n) {
  VERISIM_ASSERT(m > 0);
  VERISIM_ASSERT(n > 0);
  // Partitions of u into at most i parts, none above k: by the largest part. All k of the shorter side are kept at
  // once.
  const std::size_t rows = std::max(m, n), columns = std::min(m, n);
  std::vector<std::vector<double>> ways(columns + 1, std::vector<double>(m * n + 1, 0.0));
  for (auto& row : ways) row[0] = 1;  // of no part: u = 0
  for (std::size_t i = 1; i <= rows; ++i) {
    // ways[k] of i parts = ways[k] of i - 1 parts, shifted by k, + ways[k - 1] of i parts
    for (std::size_t u = 1; u <= m * n; ++u) ways[0][u] = 0;
    for (std::size_t k = 1; k <= columns; ++k) {
      for (std::size_t u = m * n + 1; u-- > 0;) {
        const double with_k = u >= k ? ways[k][u - k] : 0;
        ways[k][u] = with_k + ways[k - 1][u];
      }
    }
  }
  return cumulated(std::move(ways[columns]));
}

std::vector<double> w_probabilities(std::size_t n) {
  std::vector<std::size_t> ranks(n);
  std::iota(ranks.begin(), ranks.end(), std::size_t{1});
  return cumulated(signed_sums(ranks));
}

double least_p_of_pairs(std::size_t n) {
  return std::min(1.0, 2 * std::ldexp(1.0, -static_cast<int>(std::min<std::size_t>(n, 1000))));
}

double least_p_of_samples(std::size_t m, std::size_t n) {
  double ways = 1;  // (m + n) over m
  for (std::size_t i = 1; i <= m; ++i) ways *= static_cast<double>(n + i) / static_cast<double>(i);
  return std::min(1.0, 2 / ways);
}

std::vector<double> holm(std::span<const double> p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t k) { return p[i] < p[k]; });
  std::vector<double> corrected(p.size());
  double least = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    least = std::max(least, std::min(1.0, static_cast<double>(p.size() - i) * p[order[i]]));
    corrected[order[i]] = least;
  }
  return corrected;
}

}  // namespace verisim::compare
