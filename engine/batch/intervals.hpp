// Intervals of 95 % for what a summary says.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace verisim::batch {

struct Interval {
  double low = 0, high = 0;
};

/// Of a share of `count` among `all`: Wilson's score interval (Wilson 1927), which stays within 0 and 1 and says
/// something of 0 and of all, too. @pre count <= all; all > 0
[[nodiscard]] Interval wilson(std::uint64_t count, std::uint64_t all);

/// Fewer values than this have their mean's interval from Student's t: it is none of their resamples' 95 % (of five at
/// most 94 % of normal values' means lie between the least and the largest value).
inline constexpr std::size_t kBootstrapLeast = 6;

/// Of the mean: bootstrap (Efron 1979) of 2000 resamples, fewer of more than 10^4 values, 200 at least; drawn from the
/// stream `name` of `seed`: the same digits every time. Its quantiles are those of the expanded percentile interval
/// (Hesterberg 2015, The American Statistician 69): plain ones hold the mean of 10 normal values in 90 % only. None of
/// one value, which does not say how it scatters. @pre there is a value
[[nodiscard]] std::optional<Interval> interval_of_mean(const std::vector<double>& values, std::uint64_t seed,
                                                       const std::string& name);

/// Sum in the order of the values by their number. @pre there is a value
[[nodiscard]] double mean_of(const std::vector<double>& values);

}  // namespace verisim::batch
