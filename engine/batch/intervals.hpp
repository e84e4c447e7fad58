// Intervals of 95 % for what a summary says.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace verisim::batch {

struct Interval {
  double low = 0, high = 0;
};

/// Of a share of `count` among `all`: Wilson's score interval (Wilson 1927), which stays within 0 and 1 and says
/// something of 0 and of all, too. @pre count <= all; all > 0
[[nodiscard]] Interval wilson(std::uint64_t count, std::uint64_t all);

/// Of the mean: percentile bootstrap (Efron 1979) of 2000 resamples, fewer of more than 10^4 values, 200 at least;
/// drawn from the stream `name` of `seed`: the same digits every time. Of one value that value. @pre there is a value
[[nodiscard]] Interval bootstrap_of_mean(const std::vector<double>& values, std::uint64_t seed,
                                         const std::string& name);

/// Sum in the order of the values by their number. @pre there is a value
[[nodiscard]] double mean_of(const std::vector<double>& values);

}  // namespace verisim::batch
