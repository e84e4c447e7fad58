// Times of one query per pose, over a list of poses. Rounds are repeated and each pose keeps its best time: a neighbour
// on the machine can only add. Medians and percentiles are then over poses, not over noise.
#pragma once

#include <algorithm>
#include <chrono>
#include <limits>
#include <numeric>
#include <vector>

#include "engine/base/pose.hpp"
#include "engine/base/quantile.hpp"

namespace verisim::bench {

class PoseTimes {
 public:
  explicit PoseTimes(const std::vector<Pose>& poses)
      : poses_(&poses), best_(poses.size(), std::numeric_limits<double>::infinity()) {}

  /// One round: `prepare` outside the clock, `run` inside, for every pose.
  template <typename Prepare, typename Run>
  void round(const Prepare& prepare, const Run& run) {
    using Clock = std::chrono::steady_clock;
    for (std::size_t i = 0; i < best_.size(); ++i) {
      prepare((*poses_)[i]);
      const auto start = Clock::now();
      run((*poses_)[i]);
      best_[i] = std::min(best_[i], std::chrono::duration<double, std::micro>(Clock::now() - start).count());
    }
  }
  template <typename Run>
  void round(const Run& run) {
    round([](const Pose&) {}, run);
  }

  /// Microseconds; 0.5 is the median over the poses.
  [[nodiscard]] double percentile(double p) const {
    std::vector<double> times = best_;
    return quantile(times, p);
  }

  /// Microseconds, over the poses.
  [[nodiscard]] double mean() const {
    return std::accumulate(best_.begin(), best_.end(), 0.0) / static_cast<double>(best_.size());
  }

 private:
  const std::vector<Pose>* poses_;
  std::vector<double> best_;
};

}  // namespace verisim::bench
