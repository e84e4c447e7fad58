// A straight line through points by least squares, and how much of the spread it explains.
#pragma once

#include <span>

namespace verisim {

struct Regression {
  double slope = 0;
  double intercept = 0;
  double r_squared = 0;  ///< 1 - residual squares / squares about the mean; 0 if all y are equal
};

/// @pre x.size() == y.size(), at least two different x, all finite
[[nodiscard]] Regression fit_line(std::span<const double> x, std::span<const double> y);

}  // namespace verisim
