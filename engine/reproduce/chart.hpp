// The two charts that reproductions draw.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "engine/base/statistics.hpp"

namespace verisim::reproduce {

/// Values over values, from zero to a range of round ends.
struct Curve {
  std::string name;
  std::vector<std::pair<double, double>> points;  ///< x, y; not negative
};
/// @pre every curve has two points or more, with x and y above 0 among them
[[nodiscard]] std::string line_chart(const std::string& x_label, const std::string& y_label,
                                     const std::vector<Curve>& curves);

/// Means with their intervals: a row for each condition, a dot and a line for each series in it.
struct IntervalRow {
  std::string name;
  std::vector<Estimate> estimates;  ///< one of each series
};
/// Logarithmic; what is not above 0 has no dot. @pre each row has as many estimates as there are series
[[nodiscard]] std::string interval_chart(const std::string& x_label, const std::vector<std::string>& series,
                                         const std::vector<IntervalRow>& rows);

}  // namespace verisim::reproduce
