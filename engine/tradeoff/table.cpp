#include "engine/tradeoff/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "engine/base/error.hpp"
#include "engine/base/quantile.hpp"

namespace verisim::tradeoff {
namespace {

/// ns for each count, fitted to mean frame times (least relative squares, none negative: bench/tradeoff_weights.py) of
/// 39 settings of peg_in_hole, tray, slide, stack and iso_fit on one busy core of a 2.6 GHz EPYC, 5 us to 9 ms a frame.
/// Typical error 27 %, at most a factor of 1.9. For comparing settings and machines, not for predicting one.
struct Weight {
  const char* counter;
  double ns;
};
constexpr double kNsOfFrame = 570;
constexpr std::array kWeights = {Weight{"links", 3450},  Weight{"points_tested", 5.8}, Weight{"contacts", 29},
                                 Weight{"lookups", 6.4}, Weight{"exact_samples", 90},  Weight{"solver_steps", 7300}};

/// Error of a row, or nothing.
std::optional<double> error_of(const Row& row, Kind by) {
  if (!row.failed.empty()) return {};
  const std::optional<Spread>& error = row.errors[index_of(by)];
  if (!error) return {};
  return error->most;
}

}  // namespace

Interval interval_of(std::vector<double> values) {
  VERISIM_ASSERT(!values.empty());
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  // P(fewer than k of n are below the median), exactly: the k-th from either end bounds it with 1 - 2 P.
  constexpr double kEachSide = 0.025;
  std::size_t k = 0;
  double term = std::ldexp(1.0, -static_cast<int>(n)), below = term;
  while (below <= kEachSide && k + 1 < n) {
    ++k;
    term *= static_cast<double>(n - k + 1) / static_cast<double>(k);
    below += term;
  }
  const std::size_t at = k > 0 ? k - 1 : 0;
  return {(values[(n - 1) / 2] + values[n / 2]) / 2, values[at], values[n - 1 - at], values.back()};
}

std::optional<Spread> spread_of(const std::vector<Errors>& repetitions, std::size_t kind) {
  VERISIM_ASSERT(!repetitions.empty());
  std::vector<double> values;
  for (const Errors& errors : repetitions) {
    if (!errors[kind]) return {};
    values.push_back(*errors[kind]);
  }
  if (kind == index_of(Kind::flips)) {
    const double share = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
    return Spread{share, share};
  }
  const double most = *std::max_element(values.begin(), values.end());
  return Spread{quantile(values, 0.5), most};
}

double coverage_of(std::uint64_t repetitions) {
  return static_cast<double>(repetitions) / static_cast<double>(repetitions + 1);
}

void find_dominated(std::vector<Row>& rows, Kind by) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].dominated.reset();
    const std::optional<double> own = error_of(rows[i], by);
    if (!own) continue;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const std::optional<double> other = error_of(rows[k], by);
      if (k == i || !other) continue;
      const double t_i = rows[i].load(), t_k = rows[k].load();
      if (!(t_k <= t_i && *other <= *own && (t_k < t_i || *other < *own))) continue;
      const auto& best = rows[i].dominated;
      if (!best || *other < *error_of(rows[*best], by) ||
          (*other == *error_of(rows[*best], by) && t_k < rows[*best].load()))
        rows[i].dominated = k;  // of several the most accurate, which is on the front
    }
  }
}

std::vector<std::size_t> front_of(const std::vector<Row>& rows, Kind by) {
  std::vector<std::size_t> front;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (error_of(rows[i], by) && !rows[i].dominated) front.push_back(i);
  std::stable_sort(front.begin(), front.end(),
                   [&](std::size_t a, std::size_t b) { return rows[a].load() < rows[b].load(); });
  return front;
}

double counted_work_us(const std::vector<std::pair<std::string, std::uint64_t>>& cost, std::uint64_t frames) {
  if (frames == 0) return 0;
  double ns = kNsOfFrame * static_cast<double>(frames);
  for (const Weight& weight : kWeights)
    for (const auto& [counter, total] : cost)
      if (counter == weight.counter) ns += weight.ns * static_cast<double>(total);
  return ns / 1000 / static_cast<double>(frames);
}

}  // namespace verisim::tradeoff
