// Rank tests of two samples of times, and the null distributions that they and their intervals (shift.hpp) rest on.
//
// Times have long tails and no known distribution, so nothing here assumes one. Samples that were taken independently
// are told apart by Mann and Whitney's U (Annals of Mathematical Statistics 18, 1947), pairs by Wilcoxon's signed ranks
// (Biometrics Bulletin 1, 1945). Normal tails come from Boost.Math.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace verisim::compare {

struct RankTest {
  double statistic = 0;  ///< U of the first sample, or the sum of the ranks of positive differences
  double p = 1;          ///< two-sided
};

/// Mann-Whitney. As SciPy's mannwhitneyu (method "auto"), so as Google Benchmark's compare.py: exact if one sample has
/// at most 8 values, the other at most 10,000 / 8, and none are equal; else the normal approximation, corrected for
/// ties and continuity. O(n log n), exact: O(a^2 b^2).
/// @pre neither sample is empty or has a NaN
[[nodiscard]] RankTest mann_whitney(std::span<const double> a, std::span<const double> b);

/// Wilcoxon's signed ranks. Differences of 0 are left out; equal ones share their ranks. Exact for up to 100 of them,
/// ties included (the distribution over all signs of these very ranks); else the normal approximation.
/// If which of a pair came first was drawn by lot, the exact test needs nothing else: under "no difference" every sign
/// is as likely as the other, whatever the noise does.
/// @pre no NaN
[[nodiscard]] RankTest signed_rank(std::span<const double> differences);

/// P(U <= u) of sample sizes m and n without ties, for u = 0 ... m n. @pre m, n > 0
[[nodiscard]] std::vector<double> u_probabilities(std::size_t m, std::size_t n);

/// P(W <= w) of n pairs without ties, for w = 0 ... n (n + 1) / 2.
[[nodiscard]] std::vector<double> w_probabilities(std::size_t n);

/// The p that n pairs have at least, all of one sign; and two samples, all of one below all of the other.
[[nodiscard]] double least_p_of_pairs(std::size_t n);
[[nodiscard]] double least_p_of_samples(std::size_t m, std::size_t n);

/// Holm's step-down correction of several tests (Scandinavian Journal of Statistics 6, 1979): the chance that any of
/// them is below alpha, where none should be, is at most alpha. In the order given.
[[nodiscard]] std::vector<double> holm(std::span<const double> p);

}  // namespace verisim::compare
