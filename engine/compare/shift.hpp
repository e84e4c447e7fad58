// By what factor one sample of times is above another: Hodges and Lehmann's estimate (Annals of Mathematical Statistics
// 34, 1963) on logarithms, and the interval that inverts the rank test beside it (Hollander, Wolfe, Chicken,
// Nonparametric Statistical Methods, 3rd edition, sections 3.3 and 4.3). One wild value moves neither.
#pragma once

#include <span>

namespace verisim::compare {

/// Ends are -infinity or infinity where so few values bound nothing.
struct Shift {
  double estimate = 0, low = 0, high = 0;
};

/// Median of all b_k - a_i, with the interval that belongs to Mann and Whitney's test. Exact up to 50 by 50, beyond by
/// the normal approximation. O(a b log(a b)).
/// @pre neither is empty or has a NaN; 0 < level < 1
[[nodiscard]] Shift shift_of_samples(std::span<const double> a, std::span<const double> b, double level);

/// Median of all (d_i + d_k) / 2, i <= k, with the interval that belongs to Wilcoxon's signed ranks. O(n^2 log n).
/// @pre there is one, none is NaN; 0 < level < 1
[[nodiscard]] Shift shift_of_pairs(std::span<const double> differences, double level);

/// The mean of the two in the middle, of an even number. @pre there is one
[[nodiscard]] double median_of(std::span<const double> values);

}  // namespace verisim::compare
