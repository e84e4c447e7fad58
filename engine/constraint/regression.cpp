#include "engine/constraint/regression.hpp"

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim {
namespace {

double mean(std::span<const double> values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

}  // namespace

Regression fit_line(std::span<const double> x, std::span<const double> y) {
  VERISIM_ASSERT(x.size() == y.size());
  const double x_mean = mean(x);
  const double y_mean = mean(y);
  double xx = 0;
  double xy = 0;
  double yy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - x_mean) * (x[i] - x_mean);
    xy += (x[i] - x_mean) * (y[i] - y_mean);
    yy += (y[i] - y_mean) * (y[i] - y_mean);
  }
  VERISIM_ASSERT(is_positive(xx));
  VERISIM_ASSERT(is_not_negative(yy));
  Regression line;
  line.slope = xy / xx;
  line.intercept = y_mean - line.slope * x_mean;
  if (yy > 0) line.r_squared = xy * xy / (xx * yy);
  return line;
}

}  // namespace verisim
