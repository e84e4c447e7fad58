// Means of few samples with confidence intervals. Sums are taken in the order of the samples.
#pragma once

#include <span>
#include <utility>

namespace verisim {

struct Estimate {
  double value = 0;
  std::pair<double, double> interval{};  ///< 95 % confidence (Student's t)
};

/// The mean. @pre there are two samples or more
[[nodiscard]] Estimate mean_of(std::span<const double> samples);

/// Ratio estimate sum(a) / sum(b) of pairs of samples, with the interval of the linearized ratio. Not a number if
/// sum(b) is 0. @pre as many of a as of b, two or more
[[nodiscard]] Estimate ratio_of(std::span<const double> a, std::span<const double> b);

}  // namespace verisim
